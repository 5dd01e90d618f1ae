# SPDX-License-Identifier: Apache-2.0
#
# One CPU in virtual time: how late edmd wakes, and cyclictest.
. ./lib.sh
J=$PWD
cp "$(command -v cyclictest)" $R/
cat "$R/cyclictest" > /dev/null
cd $R

# How late edmd wakes, and cyclictest at the same priority and interval.
edmd_start ./edmd line.ini
sleep 1
ctl --json latency 5 > latency
kill $edmd; wait $edmd
./cyclictest -m -q -t1 -p80 -i100 -D5 -h200 > cyclictest.txt
# The kernel's tick comes each 4 ms, a whole number of these periods: whether it
# is in the way is the same in all of a run.  edmd wakes in the middle of a
# period; cyclictest does the same, and in other runs elsewhere.
for p in 100:2 250:4 1000:10; do
	seconds=${p#*:} p=${p%:*}
	sed "s/period_us = .*/period_us = $p/; s/^v_max_mm_s = .*/v_max_mm_s = 0.5/" \
		line.ini > wake.ini
	for run in 1 2 3; do
		edmd_start ./edmd wake.ini
		sleep 0.$run
		ctl --json latency $seconds
		kill $edmd; wait $edmd
		./cyclictest -m -q -t1 -p80 -i$p -D$seconds -h200 \
			--secaligned=$((p / 2)) >> peers.$p
	done > wakes.$p
	for at in 0 5 10 85 90 95; do
		./cyclictest -m -q -t1 -p80 -i$p -D1 -h200 --secaligned=$at
	done > others.$p
done
chmod a+r *; cp wakes.* peers.* others.* latency cyclictest.txt $J/
true
