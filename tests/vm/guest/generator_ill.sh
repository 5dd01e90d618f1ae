# SPDX-License-Identifier: Apache-2.0
#
# A cut that is disturbed at random, and its generator too.
. ./lib.sh
ip link set lo up
cp ill.tech generator_ill.py $R/
J=$PWD
cd $R
pull sim0 20 up		# the gap stays open
rm -rf store; mkdir store
s=$(base sim1) x=$(base sim0)
echo $((s - x)) > $J/spark
trace_start "gpio==$s || gpio==$x || gpio==$((x + 1))"
./edmd-jobs --config ill.ini --store $R/store 2> jobs.log & jobs=$!
$PYTHON generator_ill.py $R $(cat $J/seed) > $J/ill.json 2> $J/ill.txt
echo $? > $J/ill.rc
trace_end sim0 $J/ill.trace
kill $jobs; wait $jobs
cat edmd.log jobs.log > $J/ill.log
true
