# SPDX-License-Identifier: MIT
# A first boot with I2C off; then an adapter comes whose chip has nothing on its wire. The service is
# up all the time and says what is missing.
. /run/rig/guest.sh

untouched() { cmp -s $file $packaged && [ ! -e $done ] && [ "$(ls -A /etc/owsd)" = OWS.rio ]; }

does 'without I2C the service is up' within $start active owsd@OWS
same 'there is no adapter' '' "$(ls -d /dev/i2c-* 2>/dev/null)"
does 'the first start has been' active owsd-firstboot
does 'it says that it made no configuration' said owsd-firstboot 'no configuration was made'
does 'and why, with what mends it' said owsd-firstboot 'no /dev/i2c-*: switch I2C on'
does 'the file is the packaged one' untouched
does 'the service says why too' within $patience said owsd@OWS 'no /dev/i2c-*: switch I2C on'
same 'owsctl tells that nothing is there' 1 "$(owsctl stats | grep -c '^target.* i2c:auto: [ds]')"

# I2C is switched on: there is a chip, and no device
cp none.sim house.sim
does 'an adapter comes' systemctl start simchip
does 'with its device' within $patience test -c /dev/i2c-0
does 'the service takes it by itself' within $patience said owsd@OWS 'i2c:auto: from down to up'
same 'it was never started twice' 0 "$(systemctl show -P NRestarts owsd@OWS)"
systemctl stop owsd@OWS # which has the chip
does 'who does not want to wait for the next start looks at once' systemctl restart owsd-firstboot owsd@OWS
does 'nothing is found, which is said' log owsd-firstboot 'no configuration was made'
does 'the file is the packaged one' untouched
does 'the service is up' active owsd@OWS
finish
