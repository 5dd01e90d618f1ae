# SPDX-License-Identifier: Apache-2.0
#
# One CPU in virtual time, an instruction a ns: pulses of the edge thread, which
# does not sleep between edges that are close.
. ./lib.sh
J=$PWD
cd $R
echo -1 > /proc/sys/kernel/sched_rt_runtime_us
job_traced edges ./edmd edges.ini edges.ngc
job_traced even ./edmd even.ini even.ngc gpio==$(base sim0)
job_traced fast ./edmd fast.ini fast.ngc gpio==$(base sim0)
# How fast a line goes, as somebody with a new board asks; and what is refused.
trace_start gpio==$(($(base sim0) + 9))
./edmctl doctor --pulses gpiochip0:9 > pulses 2>&1
echo $? > pulses.rc
trace_end sim0 pulses.trace
hold_line gpiochip0 6
for line in gpiochip0:6 gpiochip0:32 gpiochip9:1 nine; do
	echo "$line:"; ./edmctl doctor --pulses $line; echo "rc $?"
done > pulses.refused 2>&1
release_line
chmod a+r *; cp pulses pulses.refused *.trace *.job *.rc *.log *.edmd-rc *.status $J/
true
