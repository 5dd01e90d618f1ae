# SPDX-License-Identifier: Apache-2.0
#
# Strict drives of CiA 402 on vcan0; what is done to them is in
# can402_strict.py.
. ./lib.sh
. ./strict.env
ip link set vcan0 txqueuelen 1000 up
cp can402.py strict.py can402_strict.py commission.py person.py $R/
$PYTHON $R/can402_strict.py $R $SEED $RUNS $SCENES
dmesg | grep -E 'Call Trace|WARNING:|BUG:|detected.*stall|soft lockup' > kernel
true
