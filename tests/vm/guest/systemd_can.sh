# SPDX-License-Identifier: Apache-2.0
#
# Sourced by systemd.sh: the CAN interface of the drives comes after edmd was
# asked for.  udev is what makes it a device of systemd's.
device=sys-subsystem-net-devices-can0.device

is_active() { [ "$(unit ActiveState)" = active ]; }
# How long systemd waits for it: 90 s, if nothing else is said.
wait_for_it() {
	mkdir -p /run/systemd/system/$device.d
	printf '[Unit]\nJobRunningTimeoutSec=%s\n' $1 \
		> /run/systemd/system/$device.d/wait.conf
	systemctl daemon-reload
}
waits() { systemctl list-jobs edmd.service | grep -q 'edmd.*start.*waiting'; }
tried() { [ "$(unit NRestarts)" -ge $1 ]; }

{
cp can.ini /etc/edmd/machine.ini
mkdir -p /etc/systemd/system/edmd.service.d
cp /usr/local/share/edmd/edmd-can.conf /etc/systemd/system/edmd.service.d/can.conf
wait_for_it infinity
systemctl start systemd-udevd.service
echo "udev $?"

# It comes while systemd waits for it.
systemctl start --no-block edmd.service
turns 200 waits && echo "without it: waits, $(unit ActiveState)"
sleep 3
echo "later: $(waits && echo waits), $(unit ActiveState)"
journalctl -u edmd --no-pager -o cat | grep -c can0 | sed 's/^/told before: /'
ip link add dev can0 type vcan
ip link set can0 up
turns 600 is_active && echo "it came: $(unit ActiveState)"
systemctl stop edmd.service
ip link del can0

# It comes when systemd does not wait any more, and is brought up later still.
wait_for_it 1
systemctl start --no-block edmd.service
turns 600 tried 8 && echo "without it: tried"
ip link add dev can0 type vcan
n=$(unit NRestarts)
turns 600 tried $((n + 2)) && echo "down: tried again"
ip link set can0 up
turns 600 is_active && echo "up: $(unit ActiveState)"
systemctl stop edmd.service
} > late-can 2>&1
