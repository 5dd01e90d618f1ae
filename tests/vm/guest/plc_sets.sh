# SPDX-License-Identifier: Apache-2.0
#
# A generator that a PLC sets: one that does it, and one that does not.
. ./lib.sh
ip link add dev vcan1 type vcan
ip link set vcan1 up
cp paper.tech plc_sets.py edmd.eds $R/
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

J=$OLDPWD
pull sim0 20 up		# the gap stays open
scenes good paper.ngc good
scenes ill slow.ngc late lies refuses silent resets
true
