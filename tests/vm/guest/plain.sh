# SPDX-License-Identifier: Apache-2.0
#
# Two CPUs in real time: what depends on no timing.
. ./lib.sh
uname -a > uname
cat /sys/kernel/realtime > realtime
gpiodetect > chips

# Both daemons and a client, without and with a gap.
for m in null sim; do
	edmd_start $R/edmd $m.ini
	jobs_start $m.ini
	ctl submit --wait quick.ngc > smoke-$m 2>&1
	echo $? > smoke-$m.rc
	daemons_end smoke-$m
done

# What is refused at the start.
refused() {	# NAME [USER]
	set -- $1 ${2:+setpriv --reuid=$2 --clear-groups}
	name=$1; shift
	timeout 300 "$@" $R/edmd --config $R/$name.ini 2> $R/refused
	echo $? > $name.rc
	cp $R/refused $name.txt
	rm -f /dev/shm/edmd.vm.*
	timeout 300 "$@" $R/edmd2 --config $R/$name.ini 2> $R/refused
	echo $? > $name.rc2
	cp $R/refused $name.txt2
	rm -f /dev/shm/edmd.vm.*
}
refused no-chip
refused no-line
hold_line gpiochip0 6
refused busy
release_line
refused rights nobody

# How fast a line goes, as somebody with a new board asks.
ctl doctor --pulses gpiochip0:9 > pulses 2>&1
echo $? > pulses.rc

# A generator on lines, in a gap that stays open.
sense_is() { [ "$(level sim1 9)" = $1 ]; }
cp levels.tech $R/
pull sim0 20 up
edmd_start $R/edmd generator.ini
jobs_start generator.ini
trace_start "gpio>=$(base sim1) && gpio<$(($(base sim1) + 10))"
ctl submit --wait levels.ngc > generator 2>&1
echo $? > generator.rc
# It feels its way to contact, by the voltage that is there for that alone.
ctl submit feel.ngc > feel 2>&1
turns 100 sense_is 1 || echo "no sense voltage"
pull sim0 20 down; pull sim0 22 up
turns 100 sense_is 0 || echo "the sense voltage stays"
pull sim0 22 down; pull sim0 20 up
ctl stop >> feel 2>&1
trace_end sim1 generator.trace
daemons_end generator
pull sim0 20 down

# Switches: each is its fault; sparks and pump are off by then.
pull sim0 20 up
edmd_start $R/edmd gap.ini
jobs_start gap.ini
{
ctl submit slow.ngc
status_is 'state *approach' && echo "approach: spark $(level sim1 0)"
pull sim0 21 up; pull sim0 20 down
status_is 'state *erode' && echo "erode: spark $(level sim1 0)"
pull sim0 22 up
status_is 'state *retract' && echo "retract: spark $(level sim1 0)"
pull sim0 20 up; pull sim0 22 down; pull sim0 21 down
for s in '16 e-stop' '17 limit-switch' '18 door' '19 dielectric'; do
	set -- $s
	status_is "$cutting" || break
	pull sim0 $1 up
	status_is "fault *$2" && status_is 'state *fault' &&
		echo "$2: spark $(level sim1 0)"
	pull sim0 $1 down
	goes_on
done
} > switches 2>&1

# A chip that is taken away while sparks are on; the other one still answers.
{
status_is "$cutting" && echo "before: spark $(level sim1 0)"
echo 0 > /sys/kernel/config/gpio-sim/sim0/live
status_is 'fault *io-lost' && echo "io-lost: spark $(level sim1 0)"
a=$(level sim1 1); n=0; moved=0
while [ $n -lt 20 ]; do
	sleep 0.01; n=$((n + 1))
	[ "$(level sim1 1)" = $a ] || moved=1
done
echo "watchdog moved $moved"
ctl status
} > lost 2>&1
echo 1 > /sys/kernel/config/gpio-sim/sim0/live
daemons_end lost

dmesg | grep -E 'Call Trace|WARNING:|BUG:|detected.*stall|soft lockup' > kernel
true
