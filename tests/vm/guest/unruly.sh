# SPDX-License-Identifier: Apache-2.0
#
# Unruly drives of CiA 402 on vcan0; what is done to them is in
# can402_unruly.py.
. ./lib.sh
. ./unruly.env
ip link set vcan0 txqueuelen 1000 up
tc -V > /dev/null
cp can402.py unruly.py stranger.py can402_unruly.py edmd.eds $R/
$PYTHON $R/can402_unruly.py $R $SEED $RUNS $SCENES
dmesg | grep -E 'Call Trace|WARNING:|BUG:|detected.*stall|soft lockup' > kernel
true
