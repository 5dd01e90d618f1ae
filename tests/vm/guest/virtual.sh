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

# The gap by a converter: 0.04 V a count.
raw() { echo $1 > /sys/module/adc_sim/parameters/raw; }
raw 2000
edmd_start ./edmd adc.ini
jobs_start adc.ini
{
ctl submit adc.ngc
status_is 'state *approach' && echo "open: spark $(level sim1 0)"
raw 400
status_is 'state *erode' && sleep 0.2 && ctl --json status > adc.json &&
	echo "spark: spark $(level sim1 0)"
raw 0
status_is 'state *retract' && echo "short: spark $(level sim1 0)"
raw 2000
} > adc 2>&1
daemons_end adc
rm -f /dev/shm/edmd.vm.*

# How late edmd wakes, and cyclictest at the same priority and interval.
edmd_start ./edmd line.ini
sleep 1
ctl --json latency 5 > latency
kill $edmd; wait $edmd
./cyclictest -m -q -t1 -p80 -i100 -D5 -h200 > cyclictest.txt
# The kernel's tick comes each 4 ms, a whole number of these periods: whether it
# is in the way is the same in all of a run.  So, several runs: by chance, as
# they come, and of cyclictest at chosen places beside the tick.
for p in 100 250 1000; do
	sed "s/period_us = .*/period_us = $p/; s/^v_max_mm_s = .*/v_max_mm_s = 0.5/" \
		line.ini > wake.ini
	for run in 1 2 3; do
		edmd_start ./edmd wake.ini
		sleep 0.$run
		ctl --json latency 1
		kill $edmd; wait $edmd
	done > wakes.$p
	for at in 0 5 10 85 90 95; do
		./cyclictest -m -q -t1 -p80 -i$p -D1 -h200 --secaligned=$at
	done > peers.$p
done
chmod a+r *; cp adc adc.json wakes.* peers.* *.trace *.job *.rc *.log *.edmd-rc *.status latency cyclictest.txt uname $J/
true
