# SPDX-License-Identifier: Apache-2.0
#
# One CPU in virtual time: pulses and their timing.
. ./lib.sh
J=$PWD
cp "$(command -v cyclictest)" $R/
cd $R
uname -v > uname

job_traced step1 ./edmd step.ini pulses.ngc
job_traced step2 ./edmd2 step.ini pulses.ngc
job_traced slow ./edmd slow.ini pulses.ngc
job_traced quadrature ./edmd quadrature.ini pulses.ngc

# A long straight line at the fastest pulses there are: only its step line.
job_traced line ./edmd line.ini line.ngc gpio==$(base sim0)

# The gap by a converter: 0.04 V a count.
raw() { echo $1 > /sys/module/adc_sim/parameters/raw; }
raw 2000
edmd_start ./edmd adc.ini
jobs_start adc.ini
{
ctl submit adc.ngc
status_is 'state *approach' && echo "open: spark $(level sim1 0)"
raw 400
status_is 'state *erode' && sleep 0.2 && ctl --json status > adc.json &&
	echo "spark: spark $(level sim1 0)"
raw 0
status_is 'state *retract' && echo "short: spark $(level sim1 0)"
raw 2000
} > adc 2>&1
daemons_end adc
rm -f /dev/shm/edmd.vm.*

# How late the edges may be: as cyclictest is.
./cyclictest -m -q -t1 -p80 -i100 -D5 -h200 > cyclictest.txt
chmod a+r *; cp adc adc.json *.trace *.job *.rc *.log *.edmd-rc *.status cyclictest.txt uname $J/
true
