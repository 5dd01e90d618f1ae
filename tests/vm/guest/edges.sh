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
chmod a+r *; cp *.trace *.job *.rc *.log *.edmd-rc *.status $J/
true
