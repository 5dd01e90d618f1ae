# SPDX-License-Identifier: Apache-2.0
#
# Sourced by encoder.sh: the gap by a converter that does what the kernel's
# documents of industrial I/O let one do.  A count is 0.04 V.
D=$(dirname $(grep -l adc-sim /sys/bus/iio/devices/*/name))
sim() { echo $2 > /sys/module/adc_sim/parameters/$1; }
spark() { level sim1 0; }
cuts() { status_is 'state *erode'; }

# A short in a cut so shallow soon leads to its start, which is a fault.
retracts() { status_is 'state *retract\|fault *retract-at-start'; }

# After a fault, or while one is coming: until it cuts again.
again() {
	sim raw 400
	turns 50 cuts_again && echo "again after $1: spark $(spark)"
}

cuts_again() {
	ctl reset; ctl start
	status_has 'state *erode'
}

# Whether the gap was lost, and with which sparks.
lost() { status_is 'fault *gap-lost' && echo "$1: spark $(spark)"; }

{
# Somebody else reads it, with all there is in a scan.
sim raw 2000
for e in in_voltage0 in_voltage1 in_timestamp; do
	echo 1 > $D/scan_elements/${e}_en
done
echo 1 > $D/buffer/enable
exec 8< /dev/$(basename $D)
./edmd --config adc.ini
echo "in use: exit $?, its buffer $(cat $D/buffer/enable)"
exec 8<&-

edmd_start ./edmd adc.ini
jobs_start adc.ini
ctl submit adc.ngc
status_is 'state *approach' && echo "open: spark $(spark)"
sim raw 400
cuts && sleep 0.2 && ctl --json status > adc.json && echo "cuts: spark $(spark)"
sim raw 0
retracts && echo "short: spark $(spark)"
again "a short"

# 50 samples a second: 20 ms without one are no fault.
sim us 20000
sleep 2.5
ctl status | grep '^fault' | sed 's/^/slow: /'
sim us 200

# The cycle stands still, and its buffer fills up; meanwhile it is shorted.
kill -STOP $edmd
sim raw 0
sleep 1.5
kill -CONT $edmd
retracts && echo "after a pause: spark $(spark)"
again "a pause"

# Both ends of its range.
sim raw 2047
lost "upper end"
again "upper end"
sim raw -2048
lost "lower end"
again "lower end"

# It gives nothing any more, its buffer is switched off, it is taken away.
sim still 1
lost "still"
sim still 0
again "still"
echo 0 > $D/buffer/enable
lost "off"
ctl stop
daemons_end adc1
rm -f /dev/shm/edmd.vm.*
edmd_start ./edmd adc.ini
jobs_start adc.ini
ctl submit adc.ngc
cuts && echo "a new edmd: spark $(spark)"
echo adc-sim > /sys/bus/platform/drivers/adc-sim/unbind
lost "gone"
echo adc-sim > /sys/bus/platform/drivers/adc-sim/bind
ctl reset; ctl start; sleep 0.3
echo "bound again: spark $(spark)"
ctl stop
daemons_end adc2
rm -f /dev/shm/edmd.vm.*
edmd_start ./edmd adc.ini
jobs_start adc.ini
ctl submit adc.ngc
cuts && echo "bound again, a new edmd: spark $(spark)"
ctl stop
daemons_end adc3
} > adc 2>&1
rm -f /dev/shm/edmd.vm.*
cp adc adc.json adc?.log adc?.edmd-rc $J/
