# SPDX-License-Identifier: Apache-2.0
#
# One CPU in virtual time: an axis with an encoder, a brake and a line of power;
# then a converter for the gap.
# ./axis-sim is the axis: it follows the pulses, and slips when it is told to.
. ./lib.sh
J=$PWD
LOOK=0.25
cp axis-sim $R/
cd $R
b=$(base sim0)
mkfifo slip
echo mono > $T/trace_clock
echo "gpio==$b||gpio==$((b + 1))" > $T/events/gpio/gpio_value/filter
echo 1 > $T/events/gpio/gpio_value/enable
./axis-sim $T/trace_pipe $b $((b + 1)) $(chip_dir sim0)/sim_gpio24/pull \
	$(chip_dir sim0)/sim_gpio25/pull slip place 2> axis-sim.err &
axis=$!

lines() { echo "brake $(level sim0 26) enable $(level sim0 27)"; }

# The axis looks each 20 ms: it may still be on its last pulses.
ended() {
	status_is 'state *idle' && sleep 0.2 &&
		echo "at $(place) $(ctl --json status)"
}

place() { cut -d' ' -f1 place; }

# What an operator does in front of a wall, and where the axis is behind it: its
# place, and how many counts were lost at the wall so far.
beside_wall() {	# VERB ...
	ctl "$@"
	echo "rc $?"
	sleep 0.5
	echo "wall: $* $(cat place)"
}

against_a_wall() {
	echo "wall 100" > slip
	ctl submit wall.ngc
	status_is 'fault *following'
	sleep 0.2
	echo "wall: stopped $(cat place)"
	beside_wall reset
	for i in 1 2 3; do
		beside_wall retract 0.01 --wait
	done
	beside_wall stop
	beside_wall jog X -0.02 --wait
	echo open > slip
	ctl submit wall.ngc
	status_is 'state *travel' && ended
}

for name in edmd edmd2; do
	edmd_start ./$name encoder.ini
	jobs_start encoder.ini
	{
	echo "before: $(lines)"
	ctl submit encoder.ngc
	status_is 'state *travel' && sleep 1 && echo "travel: $(lines)"
	# Less than resync_mm: made good after reset and start.
	echo 50 > slip
	status_is 'fault *following' && echo "slipped: $(lines)"
	sleep 0.2
	echo "later: $(lines)"
	ctl start; echo "early start $?"
	ctl reset; status_is 'fault *none' && echo "reset: $(lines)"
	ctl start; echo "start $?"
	status_is 'state *travel' && echo "goes on: $(lines)"
	ended
	# More than that: it is not driven back.
	ctl submit encoder.ngc
	status_is 'state *travel' && sleep 1
	echo 150 > slip
	status_is 'fault *following'
	sleep 0.2; echo "pushed: $(place)"
	ctl reset; status_is 'fault *none'
	ctl start; status_is 'fault *following' && echo "far: $(place)"
	ctl stop; ctl reset; status_is 'state *idle'
	ctl submit back.ngc
	status_is 'state *travel' && ended
	against_a_wall
	} > run-$name.said 2>&1
	daemons_end run-$name
	cp run-$name.said run-$name.log run-$name.edmd-rc $J/
	rm -f /dev/shm/edmd.vm.*
done
kill $axis
cp axis-sim.err $J/
echo 0 > $T/events/gpio/gpio_value/enable
. $J/adc.sh
cd $J
dmesg | grep -E 'Call Trace|WARNING:|BUG:|detected.*stall|soft lockup' > kernel
true
