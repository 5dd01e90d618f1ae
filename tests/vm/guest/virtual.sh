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

# How late the edges may be: as cyclictest is.
./cyclictest -m -q -t1 -p80 -i100 -D5 -h200 > cyclictest.txt
chmod a+r *; cp *.trace *.job *.rc *.log *.edmd-rc *.status cyclictest.txt uname $J/
true
