# SPDX-License-Identifier: MIT
# A first boot with devices and a full disk: the scan cannot be kept, which is said, and the service is up;
# with room it is made up for. Then what else may be wrong: a broken configuration, two masters.
. /run/rig/guest.sh

good() { owsctl -n "$1" get temperature1 >/dev/null; }

does 'with a full disk the service is up' within $start active owsd@OWS
same 'the disk is full' 0 "$(df --output=avail / | tail -n 1 | tr -d ' ')"
does 'the first start says so' within $patience said owsd-firstboot 'No space left'
does 'it counts as failed' within $patience systemctl -q is-failed owsd-firstboot
does 'the file is the packaged one' cmp $file $packaged
same 'nothing else lies beside it' OWS.rio "$(ls -A /etc/owsd)"
does 'without a mark' [ ! -e $done ]
rm -f /var/full /var/full.more
systemctl stop owsd@OWS # which has the chip
does 'with room on the disk it is started again' systemctl restart owsd-firstboot owsd@OWS
does 'there is a configuration' [ -e $done ]
[ $failed = 0 ] || finish # what follows would say nothing
does 'and a value' within $patience reads temperature1 21.0625

# A broken configuration
cp $file /tmp/good.rio
sed -i 's/^  MaxRetries .*/  MaxRetries  some/' $file
does 'with a broken configuration it does not start' refused systemctl restart owsd@OWS
does 'the place is said' said owsd@OWS "$file:"
does 'systemd goes on trying' within $patience sh -c '[ "$(systemctl show -P SubState owsd@OWS)" = auto-restart ]'
does 'the last value is not good' refused good OWS
cp /tmp/good.rio $file
does 'mended it comes up by itself' within $patience active owsd@OWS
does 'with values' within $patience good OWS

# Two instances on one chip
sed 's/"auto"/"i2c:\/dev\/i2c-0"/' /tmp/good.rio >/etc/owsd/HOUSE.rio
does 'a second instance for the same chip starts' systemctl start owsd@HOUSE
does 'its log says who has it' within $patience said owsd@HOUSE 'in use by owsd'
does 'the first goes on' good OWS
does 'when that leaves' systemctl stop owsd@OWS
does 'the second has it' within $patience good HOUSE

# The kernel's driver on the same chip
does 'nobody has it' systemctl stop owsd@HOUSE
modprobe -a ds2482 w1_therm w1_ds2408 w1_ds2423
echo ds2482 0x18 >/sys/bus/i2c/devices/i2c-0/new_device
does 'with the chip in the hands of the kernel' within $patience [ -e /sys/bus/i2c/devices/0-0018/driver ]
does 'it starts' systemctl start owsd@HOUSE
does 'and says what mends it' within $patience said owsd@HOUSE '/sys/bus/i2c/drivers/ds2482/unbind'
does 'the service is up' active owsd@HOUSE
does 'no value is good' refused good HOUSE
does 'auto takes what the kernel has' systemctl start owsd@OWS
does 'and reads' within $patience good OWS
systemctl stop owsd@OWS
echo 0-0018 >/sys/bus/i2c/drivers/ds2482/unbind
does 'when the driver lets go, it has the chip' within $patience good HOUSE
finish
