# SPDX-License-Identifier: Apache-2.0
#
# The Debian packages by dpkg, with systemd as PID 1: installed, upgraded while a
# job is held, removed, purged.  old/ and new/ have them in two versions.
. ./lib.sh
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
mkdir -p $R/packages
cp -r old new $R/packages
# Neither of the two is edmd's: pages of the whole system read again, and a
# policy by which a container starts and stops nothing.
rm -f /var/lib/man-db/auto-update /usr/sbin/policy-rc.d
ctl() { /usr/bin/edmctl --machine shop "$@"; }
unit() { systemctl show -P $1 $2; }
state_is() { status_is "state *$1"; }
job_is() { turns 150 job_has $1; }
job_has() { ctl show held > $R/show 2>&1 && grep -q "$1" $R/show; }
units="edmd.service edmd-jobs.service edm-dds.service edm-panel.service"

# Every file that the packages bring, and where services keep their own.
for p in $R/packages/new/*.deb; do
	dpkg-deb -c $p | awk '$1 !~ /^d/ { print substr($6, 2) }'
done | sort -u > $R/files

# left - what of edmd is on this host
left() {
	while read -r f; do
		[ ! -e "$f" ] || echo "$f"
	done < $R/files
	for d in /etc/edmd /var/lib/edmd /dev/shm /etc/systemd/system; do
		[ ! -e $d ] || find $d -name '*edm*'
	done
}

{
left > before
dpkg -i $R/packages/old/*.deb > install.log 2>&1
echo "install $?"
for u in $units; do echo "$u $(unit ActiveState $u)"; done
echo "users $(getent passwd edmd edm-jobs edm-panel | cut -d: -f1 | xargs)"
grep -q '^backend = null' /etc/edmd/machine.ini && echo "template null"
} > installed 2>&1

{
sed -i -e 's/^name = edm .*/name = shop/' -e '/^backend = null/r settings.ini' \
	/etc/edmd/machine.ini
md5sum < /etc/edmd/machine.ini > $R/mine
systemctl enable edmd.service edmd-jobs.service edm-panel.service 2>/dev/null
systemctl start $units
echo "start $?"
ctl submit --id held job.ngc
state_is 'erode\|approach\|travel' && ctl hold
state_is hold && echo "before held"
ctl show held > show-before
old=$(unit MainPID edmd.service) oldjobs=$(unit MainPID edmd-jobs.service)
panel=$(unit MainPID edm-panel.service)
dpkg -i $R/packages/new/*.deb > upgrade.log 2>&1
echo "upgrade $?"
echo "version $(dpkg-query -W -f '${Version}' edmd)"
[ $(unit MainPID edmd.service) = $old ] && echo "edmd same"
[ $(unit MainPID edmd-jobs.service) = $oldjobs ] && echo "edmd-jobs same"
[ $(unit MainPID edm-panel.service) != $panel ] && echo "edm-panel new"
echo "panel $(unit ActiveState edm-panel.service)"
[ "$(md5sum < /etc/edmd/machine.ini)" = "$(cat $R/mine)" ] && echo "config mine"
state_is hold && echo "after held"
ctl show held > show-after
ctl start; state_is 'erode\|approach\|travel' && echo "after goes-on"
ctl hold; state_is hold
# The new programs take the job over, where it is held.
systemctl restart edmd.service edmd-jobs.service
echo "restart $?"
[ $(unit MainPID edmd.service) != $old ] && echo "edmd-later new"
state_is hold && echo "restarted held"
ctl show held > show-restarted
ctl step +1; state_is hold; ctl start
job_is done && echo "job done"
} > upgraded 2>&1

{
dpkg -r edm-panel edm-plan edmd-clients libinterp-dev edmd \
	> remove.log 2>&1
echo "remove $?"
for u in $units; do echo "$u $(unit ActiveState $u)"; done
[ -e /etc/edmd/machine.ini ] && echo "config kept"
[ -e /var/lib/edmd ] && echo "store kept"
left > after-remove
dpkg --purge edm-panel edm-plan edmd-clients libinterp-dev edmd \
	> purge.log 2>&1
echo "purge $?"
left > after-purge
} > removed 2>&1
journalctl -u edmd -u edmd-jobs -u edm-panel -u edm-dds --no-pager -o short-monotonic > journal
true
