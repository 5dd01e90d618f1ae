# SPDX-License-Identifier: Apache-2.0
#
# A PLC on a second CAN interface: one that loads our EDS, one our DBC, and one
# that says what must not be believed.
. ./lib.sh
. ./plc.env
ip link add dev vcan1 type vcan
ip link set vcan1 up

for plc in eds dbc bad; do
	edmd_start $R/edmd plc.ini
	jobs_start plc.ini
	ctl electrode add 3 name=rib > $plc.txt 2>&1
	ctl submit --hold cut.ngc >> $plc.txt 2>&1
	ctl submit --hold cut.ngc >> $plc.txt 2>&1
	$PYTHON plc.py $plc vcan1 > $plc.json 2>> $plc.txt
	echo $? > $plc.rc
	ctl status >> $plc.txt
	ctl stop >> $plc.txt 2>&1
	daemons_end $plc
	rm -f /dev/shm/edmd.vm.*
done

# Without the interface it is to be on.  No time limit: virtual time may run far
# while a file is waited for.
sed 's/vcan1/vcan7/' plc.ini > $R/nowhere.ini
$R/edmd --config $R/nowhere.ini 2> $R/nowhere.txt
echo $? > nowhere.rc
cp $R/nowhere.txt .
true
