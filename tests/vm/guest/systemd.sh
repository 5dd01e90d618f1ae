# SPDX-License-Identifier: Apache-2.0
#
# systemd as PID 1, the units as `make install` puts them.
. ./lib.sh
unit() { systemctl show -P $1 edmd.service; }

# replaced PID - wait until systemd has started another edmd than that
replaced() { turns 600 is_another $1; }
is_another() {
	now=$(unit MainPID)
	[ "$now" != 0 ] && [ "$now" != $1 ] && [ "$(unit SubState)" = running ]
}

# fifo PID - "priority thread" of each of its threads in real time, sorted
fifo() {
	chrt -a -p $1 |
		sed -n "s/.*pid \([0-9]*\)'s.*priority: \([1-9].*\)/\2 \1/p" | sort -n
}
# cycle PID - the one with the highest priority
cycle() { fifo $1 | sed -n '$s/.* //p'; }
{
echo "pid1 $(cat /proc/1/comm)"
cp -r root/. /
cp service.ini /etc/edmd/machine.ini
systemd-sysusers edmd.conf
systemd-tmpfiles --create edmd.conf
# There is no udev here; this is what 60-edmd.rules does.
chgrp gpio /dev/gpiochip*; chmod 660 /dev/gpiochip*

systemctl start edmd.service
echo "start $?"
echo "active $(unit ActiveState)/$(unit SubState)"
echo "type $(unit Type)"
pid=$(unit MainPID)
echo "user $(ps -o user= -p $pid)"
echo "fifo $(fifo $pid | while read -r prio tid; do
	echo "$(cat /proc/$pid/task/$tid/comm)=$prio"; done | paste -s -d' ')"
systemctl start edmd-jobs.service
pull sim0 20 up
} > start 2>&1

# Who may do what with what they share.
(cd /dev/shm/edmd && stat -c '%n %A %U %G' . *) > shared 2>&1
(cd /dev/shm/edmd-jobs && stat -c '%n %A %U %G' . *) > shared-jobs 2>&1
(cd /run/edmd-jobs && stat -c '%n %A %U %G' . *) > sockets-jobs 2>&1
(cd /run/edmd && stat -c '%n %A %U %G' . *) > sockets 2>&1
setpriv --reuid=nobody --regid=nogroup --clear-groups \
	ls /dev/shm/edmd > shared-nobody 2>&1

# What a program that listens to the network sees: the unit of edm-dds, with
# another program in it.
mkdir -p /run/systemd/system/edm-dds.service.d
cat > /run/systemd/system/edm-dds.service.d/look.conf <<END
[Service]
Type=oneshot
Restart=no
StandardOutput=file:$PWD/dds-sees
StandardError=file:$PWD/dds-sees
ExecStart=
ExecStart=/bin/sh -c 'id; head -c 4 /dev/shm/edmd/edmd.vm.status | wc -c; \
	cat /var/lib/edmd/vm.key; touch /dev/shm/edmd/edmd.vm.program.9; \
	touch /dev/shm/edmd-jobs/edmd.vm.program.9; \
	ls /run/edmd /run/edmd-jobs; true'
END
systemctl daemon-reload
systemctl start edm-dds.service

# edm-notify as its unit has it, but for a Python that has its libraries, wherever
# this project lies, /root and /tmp too: off without a file; then a fault is told,
# and the next one after it was killed.
called() { [ "$(grep -c '"kind": "fault"' notify-called)" -ge $1 ]; }
begun() { [ "$(grep -c 'calls here' notify-called)" -ge $1 ]; }
notify() { systemctl show -P $1 edm-notify.service; }
{
echo "enabled $(systemctl is-enabled edm-notify.service)"
mkdir -p /run/systemd/system/edm-notify.service.d
cat > /run/systemd/system/edm-notify.service.d/python.conf <<END
[Service]
ExecStart=
ExecStart=$PYTHON -m edm.notify --config %d/notify.ini
Environment=PYTHONPATH=${PYTHON%/.venv/*}/clients/python
ProtectHome=tmpfs
BindReadOnlyPaths=${PYTHON%/.venv/*}
StandardOutput=append:$PWD/notify-called
END
systemctl daemon-reload
systemctl start edm-notify.service
echo "without-file $(notify ConditionResult) $(notify ActiveState)"
ctl keys add notify viewer
mv notify.key /etc/edmd/
printf '[notify]\nmachine = vm\n[to.here]\nurl = command:/bin/cat\n' \
	> /etc/edmd/notify.ini
chmod 600 /etc/edmd/notify.*
: > notify-called
systemctl start edm-notify.service
echo "active $(notify ActiveState)/$(notify SubState)"
ctl estop
turns 600 called 1; echo "called $?"
pid=$(notify MainPID)
echo "user $(ps -o user= -p $pid)"
kill -9 $pid
turns 600 begun 2; echo "begun-again $?"
ctl reset
sleep 3
ctl estop
turns 600 called 2; echo "called-again $?"
ctl reset
systemctl stop edm-notify.service
echo "stopped $(notify Result)"
} > notify 2>&1

{
status_is 'edmd *ok' && ctl submit slow.ngc
status_is 'state *approach'
echo "spark $(level sim1 0)"
trace_start
trace_has_writes
pid=$(unit MainPID)
tid=$(cycle $pid)
echo "stopped $pid"
echo "stopped-cycle $tid"
./stop-thread $tid > stopped-at &
replaced $pid
wait
echo "spark-after-kill $(level sim1 0)"
status_is 'state *hold'
echo "spark-held $(level sim1 0)"
trace_end sim1 watchdog.trace
echo "active-again $(unit ActiveState)/$(unit SubState)"
goes_on
echo "spark-again $(level sim1 0)"
pid=$(unit MainPID)
echo "frozen $pid"
echo "frozen-cycle $(cycle $pid)"
trace_start
trace_has_writes
kill -STOP $pid
replaced $pid
status_is 'state *hold'
trace_end sim1 frozen.trace
ctl stop; status_is 'state *idle'
echo "spark-idle $(level sim1 0)"
systemctl stop edmd.service
echo "stop $? $(unit Result)"
} > watchdog 2>&1
. ./systemd_can.sh
journalctl -u edmd -u edmd-jobs -u edm-notify --no-pager -o short-monotonic > journal
true
