# SPDX-License-Identifier: Apache-2.0
#
# A generator that a PLC sets: one that does it, and one that does not.
. ./lib.sh
ip link add dev vcan1 type vcan
ip link set vcan1 up
cp paper.tech plc_sets.py st.py edmd.st can_generator.py edmd.eds $R/
cd $R

scenes() {	# NAME JOB SCENE ...
	name=$1 job=$2; shift 2
	edmd_start $R/edmd sets.ini
	jobs_start sets.ini
	trace_start "gpio==$(base sim1)"
	ctl submit --hold $job > $name.txt 2>&1
	$PYTHON plc_sets.py vcan1 "$@" > $name.json 2>> $name.txt
	echo $? > $name.rc
	ctl generator >> $name.txt 2>&1
	ctl stop >> $name.txt 2>&1
	trace_end sim1 $name.trace
	daemons_end $name
	rm -f /dev/shm/edmd.vm.*
	cp $name.* $J/
}

is_told() { ctl generator | grep -q '^peak_a  *A  *[a-z]*  *-  *[0-9]'; }

# Through the steps of each field, with WHO to answer; `true`: nobody.
walk() {	# NAME EVERY WHO ...
	name=$1 every=$2; shift 2
	edmd_start $R/edmd $name.ini
	jobs_start $name.ini
	"$@" 2> who.err & who=$!
	[ $1 = true ] || turns 100 is_told
	ctl generator walk --every $every > walk-$name.txt 2>&1
	echo $? > walk-$name.rc
	kill $who; wait $who
	cat who.err >> walk-$name.txt
	daemons_end walk-$name
	rm -f /dev/shm/edmd.vm.*
	cp walk-$name.* $J/
}

has_servo() { ctl generator | grep -q '^servo_v  *V  *can  *15  *15 '; }

# A cut, and what the generator on CAN has in it.
cut_can() {
	edmd_start $R/edmd can.ini
	jobs_start can.ini
	$PYTHON can_generator.py vcan1 0 2> who.err & who=$!
	ctl submit slow.ngc > cut-can.txt 2>&1
	turns 100 has_servo
	ctl generator >> cut-can.txt 2>&1
	ctl stop >> cut-can.txt 2>&1
	kill $who; wait $who
	cat who.err >> cut-can.txt
	daemons_end cut-can
	rm -f /dev/shm/edmd.vm.*
	cp cut-can.* $J/
}

J=$OLDPWD
walk sets 9973 $PYTHON plc_sets.py vcan1 idle
walk can 9973 $PYTHON can_generator.py vcan1 0
walk stuck 9973 $PYTHON can_generator.py vcan1 64
walk lines 1 true
cut_can
pull sim0 20 up		# the gap stays open
scenes good paper.ngc good
scenes ill slow.ngc late lies refuses silent resets
true
