# SPDX-License-Identifier: Apache-2.0
#
# Peak current and voltage of the generator by outputs of a converter, in a gap that
# stays open.
. ./lib.sh
cp outputs.tech $R/
J=$PWD
LOOK=0.25
cd $R
D=$(dirname $(grep -l adc-sim /sys/bus/iio/devices/*/name))
sim() { echo $2 > /sys/module/adc_sim/parameters/$1; }
outputs() { echo $(cat $D/out_voltage0_raw $D/out_voltage1_raw); }
spark() { level sim1 0; }
ended() { status_is 'state *approach' && status_is 'state *idle' && echo "$1: done"; }
sim raw 2000

{
# edmd does not begin with what the device cannot do.
./edmd --config in.ini; echo "no output: exit $?"
echo 5 > $D/out_voltage0_raw
edmd_start ./edmd dac.ini
jobs_start dac.ini
echo "begin: $(outputs)"
ctl generator
trace_start "gpio==$(base sim1)||gpio==$(($(base sim1) + 7))"
ctl submit dac.ngc
ended job
echo 0 > $T/events/gpio/gpio_value/enable
grep -E 'gpio_value:|output' $T/trace > dac.trace

# A slow bus: no spark before the value is there.
sim slow_ms 300
trace_start "gpio==$(base sim1)||gpio==$(($(base sim1) + 7))"
ctl submit dac.ngc
ended "slow job"
echo 0 > $T/events/gpio/gpio_value/enable
grep -E 'gpio_value:|output' $T/trace > slow.trace
# Too slow is a fault.
sim slow_ms 3000
ctl submit dac.ngc
status_is 'fault *generator' && echo "too slow: spark $(spark)"
sleep 8
sim slow_ms 0
ctl stop; ctl reset; status_is 'state *idle'

# It takes nothing.
sim deaf 1
ctl submit dac.ngc
status_is 'fault *generator' && echo "deaf: spark $(spark)"
sim deaf 0
ctl reset; ctl start
status_is 'state *approach' && echo "again after deaf: spark $(spark)"
ctl stop; status_is 'state *idle'

daemons_end dac
echo "end: $(outputs)"
} > $J/dac 2>&1
cp dac.log dac.trace slow.trace dac.edmd-rc $J/
