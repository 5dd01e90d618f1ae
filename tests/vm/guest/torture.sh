# SPDX-License-Identifier: Apache-2.0
#
# A host whose power fails: the machine runs its jobs, one after the other, and
# goes on with what was interrupted, until this virtual machine is killed.  What
# has to survive is on a disk of its own; what a test looks at goes to the
# shared folder, a file a turn: torture.py.
. ./lib.sh
read -r turn < turn
P=/run/power
mkdir -p $P
mount -t ext4 /dev/vda $P || exit 3
mkdir -p $P/store

say() { echo "$@" >> told.$turn; }

edmd_start $R/edmd torture.ini
$R/edmd-jobs --config torture.ini --store $P/store 2>$R/jobs.log &
jobs=$!
turns 200 jobs_answer || { cat $R/edmd.log $R/jobs.log; exit 4; }
ctl --json status > came.$turn
ctl --json queue > queue.$turn
sleep 0.5
ctl --json status > stood.$turn

read -r job < job
if grep -q '"interrupted": *"[^"]' came.$turn; then
	id=$(sed 's/.*"interrupted": *"\([^"]*\)".*/\1/' came.$turn)
	ctl --json show $id > show.$turn
	say "resume $id: $(ctl resume $id XYZABCUV 2>&1)"
	turns 200 status_has 'state *hold' || { say "not loaded: $(cat $R/status)"; cat $R/jobs.log; exit 5; }
elif ! ctl --json history | grep -q '"job": *"cut"'; then
	# Held, or it would be hard to tell whether it begins by itself.
	[ -s queue.$turn ] && grep -q '"cut"' queue.$turn ||
		say "submit: $(ctl submit --id cut --hold $job 2>&1)"
	turns 200 status_has 'state *hold' || { say "not loaded: $(cat $R/status)"; cat $R/jobs.log; exit 5; }
fi
[ -e record ] && { $R/edmctl --machine vm record --until-end $R/trace.csv > /dev/null 2>&1 & record=$!; sleep 0.5; }
say "start: $(ctl start 2>&1)"
: > begun.$turn
# What an operator saw last.  A stop (M0) is answered by a start.
until ctl --json history > $R/history 2>/dev/null && grep -q '"job": *"cut"' $R/history; do
	ctl --json status > $R/seen 2>/dev/null && cp $R/seen seen.$turn.new && mv seen.$turn.new seen.$turn
	grep -q '"state": *"hold"' $R/seen && grep -q '"fault": *"none"' $R/seen && ctl start > /dev/null 2>&1
	grep -q '"state": *"fault"' $R/seen && { say "fault: $(cat $R/seen)"; break; }
	sleep 0.1
done
[ -e record ] && { wait $record; cp $R/trace.csv trace.csv; }
ctl --json status > end
cp $R/history history
daemons_end torture
umount $P
