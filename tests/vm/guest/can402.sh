# SPDX-License-Identifier: Apache-2.0
#
# Drives of CiA 402 on vcan0; what is done to them is in can402.py.
. ./lib.sh
ip link set vcan0 txqueuelen 1000 up
cp drives.py can402.py lines.tech $R/
uname -a > uname
trace_start "gpio>=$(base sim0) && gpio<$(($(base sim0) + 32))"
$PYTHON $R/can402.py $R
trace_end sim0 lines.trace
dmesg | grep -E 'Call Trace|WARNING:|BUG:|detected.*stall|soft lockup' > kernel
true
