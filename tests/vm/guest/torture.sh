# SPDX-License-Identifier: Apache-2.0
#
# A host whose power fails: the machine runs a job, and goes on with what was
# interrupted, until this virtual machine is killed.  What has to survive is on
# a disk of its own; what a test looks at goes to the shared folder, a file a
# turn: test_torture.py.
read -r turn < turn
P=/power
mount -t ext4 /dev/vda $P || exit 3
mkdir -p $P/store

say() { echo "$@" >> told.$turn; }
name=$(sed -n "s/^name = //p" torture.ini)
ctl() { edmctl --machine $name "$@"; }

# turns N COMMAND ... - until it succeeds, N times at the most: turns, not
# seconds, because a turn takes as long as the host is slow.
turns() {
	left=$1; shift
	until "$@"; do
		left=$((left - 1))
		[ $left -gt 0 ] || return 1
		sleep 0.05
	done
}

edmd_is_up() { grep -q 'edmd: machine' /edmd.log; }
jobs_answer() { ctl --json queue > queue.$turn 2> /dev/null; }
# A line of the watch: cycle, state, fault, loaded ...
is_held() { case "$(tail -n 1 seen.$turn)" in *" hold 0 1 "*) ;; *) false ;; esac; }
held() {
	turns 400 is_held && return
	say "not loaded: $(ctl status 2>&1; cat /jobs.log)"
	exit 5
}

cp torture.ini job.ngc next.ngc /
grep -q vcan1 torture.ini && torture-help plc vcan1 > plc.$turn &
edmd --config /torture.ini 2> /edmd.log &
edmd=$!
turns 200 edmd_is_up || { cat /edmd.log; exit 4; }
torture-help watch $name > seen.$turn &
edmd-jobs --config /torture.ini --store $P/store 2> /jobs.log &
jobs=$!
turns 200 jobs_answer || { cat /edmd.log /jobs.log; exit 4; }
ctl --json history > history.$turn
# Longer than it takes to see what became of a job.
sleep 0.3
ctl --json queue > queue.$turn
for job in cut next; do
	ctl --json show $job > show-$job.$turn 2> /dev/null
done

if grep -q '"interrupted"' queue.$turn; then
	say "resume: $(ctl resume cut XYZABCUV 2>&1)"
	held
elif ! grep -q '"job": *"cut"' history.$turn; then
	# Held, or it would be hard to tell whether it begins by itself.
	grep -q '"cut"' queue.$turn ||
		say "cut: $(ctl submit --id cut --hold /job.ngc 2>&1)"
	grep -q '"next"' queue.$turn ||
		say "next: $(ctl submit --id next --hold /next.ngc 2>&1)"
	held
else
	# The power failed when it was done: there is nothing to record.
	say "done already"
	rm -f record
fi
if [ -e record ]; then
	ctl record --until-end /trace.csv > /dev/null 2>&1 &
	record=$!
	sleep 0.5
fi
: > begun.$turn
say "start: $(ctl start cut 2>&1)"
cp history.$turn history
# A stop (M0) is answered by a start.  The next job is loaded behind it.
until grep -q '"job": *"cut"' history; do
	set -- $(tail -n 1 seen.$turn)
	case "$2 $3 $4" in
	"hold 0 1") ctl start cut > /dev/null 2>&1 ||
		{ ctl --json history > history.new && mv history.new history; } ;;
	*" 0 "*) ;;
	*) say "fault: $*"; break ;;
	esac
	sleep 0.5
done
[ -e record ] && wait $record && cp /trace.csv trace.csv
kill $jobs; wait $jobs
kill $edmd; wait $edmd
cat /edmd.log /jobs.log > log.$turn
umount $P
