# SPDX-License-Identifier: Apache-2.0
#
# One CPU in virtual time: pulses and their timing.
. ./lib.sh
J=$PWD
cp "$(command -v cyclictest)" $R/
cd $R
uname -v > uname

job_traced step1 ./edmd step.ini pulses.ngc
job_traced step2 ./edmd2 step.ini pulses.ngc
job_traced slow ./edmd slow.ini pulses.ngc
job_traced quadrature ./edmd quadrature.ini pulses.ngc

# A long straight line at the fastest pulses there are: only its step line.
job_traced line ./edmd line.ini line.ngc gpio==$(base sim0)

# From an act on edmd's own socket to the line of the sparks, beside loads.
busy() {	# N - so many processes that never wait
	loads=
	for i in $(seq $1); do
		while :; do :; done &
		loads="$loads $!"
	done
}

crowd() {	# N - they connect, and say nothing
	for i in $(seq $1); do
		./stop-latency $stop crowd &
		loads="$loads $!"
	done
}

load_begin() {	# LOAD
	loads=
	case $1 in
	busy)	busy 8 ;;
	crowd)	crowd 3 ;;
	jobs)	kill -STOP $jobs ;;
	esac
	sleep 0.02
}

load_end() {
	[ -z "$loads" ] || { kill $loads; wait $loads; }
	kill -CONT $jobs
}

is_off() { [ "$(level sim1 0)" = 0 ]; }

cp $J/stop-latency .
chmod 755 stop-latency
pull sim0 20 up
edmd_start ./edmd stop.ini
jobs_start stop.ini
stop=$(ls /run/edmd/edmd.vm.stop /dev/shm/edmd.vm.stop 2>/dev/null)
ctl submit stop.ngc
trace_start gpio==$(base sim1)
for load in nothing busy crowd jobs; do
	for i in 1 2 3 4 5 6 7 8; do
		goes_on
		load_begin $load
		echo $load $(./stop-latency $stop) >> stops
		load_end
		turns 50 is_off
	done
done > stop.said 2>&1
trace_end sim1 stop.trace
pull sim0 20 down
daemons_end stop

# How late the edges may be: as cyclictest is.
./cyclictest -m -q -t1 -p80 -i100 -D5 -h200 > cyclictest.txt
chmod a+r *; cp *.trace *.job *.rc *.log *.edmd-rc *.status cyclictest.txt uname stops $J/
true
