# SPDX-License-Identifier: MIT
# A DS2490 behind USB/IP: the kernel's own driver and the genuine owserver agree with the model, with
# what usb.sim says, and with its data sheet.
. /rig/lib.sh
. /rig/w1lib.sh
. /rig/usblib.sh

PORT=4304
answers() {
	owdump $PORT dir /uncached | grep -q '^/uncached/28\.'
}

ow() {
	echo $1 | owdump $PORT read | cut -f 2 | tr -d ' '
}

reads_again() {
	[ "$(ow /uncached/28.A0B1C2000028/temperature)" = 21.0625 ]
}

# Alternate setting 3, search by the macro, strong pull-up
plug_usb
does "its search finds every chip" within 120 all_found $chips
for line in 28:00:21062:warm 28:01:-10125:parasite 28:02:124500:hot; do
	IFS=: read -r family number value what <<-END
		$line
	END
	same "w1_therm reads a thermometer that is $what" $value \
		"$(text $(name $family $number)/temperature)"
done
near "w1_therm reads a DS18S20" 25400 65 "$(text $(name 10 00)/temperature)"
same "w1_ds2431 reads the memory" 48656c6c6f "$(hex $(name 2D 00)/eeprom | cut -c 65-74)"
search_no_more
same "the kernel does nothing that the data sheet forbids" 0 "$(stat_of forbidden)"
sim stats | sed 's/^/# kernel: /'

# Pulled and put in again
sim remove adapter
does "the kernel sees it go" within 60 no_adapter
sim end remove adapter
does "and come back" within 60 one_master
does "with every chip" within 120 all_found $chips
search_no_more
rmmod ds2490

# Genuine owserver, by libusb
before=$(stat_of forbidden)
owserver -u -p 127.0.0.1:$PORT --foreground >/tmp/log/owserver 2>&1 &
server=$!
does "owserver serves the adapter" within 60 answers
same "and lists every chip" $chips \
	"$(owdump $PORT dir /uncached | grep -c '^/uncached/[0-9A-F][0-9A-F]\.[0-9A-F]*$')"
same "owserver reads a thermometer" 21.0625 "$(ow /uncached/28.A0B1C2000028/temperature)"
same "and one that the wire feeds" -10.125 "$(ow /uncached/28.A0B1C2010028/temperature)"
same "and a DS2413" 1,1 "$(ow /uncached/3A.A0B1C200003A/sensed.ALL)"
sim short 0x18
same "of a short wire owserver has no value" "" "$(ow /uncached/28.A0B1C2000028/temperature | grep -v ret=)"
sim end short 0x18
does "and has one when it is free again" within 60 reads_again
same "owserver does nothing that the data sheet forbids" 0 $(($(stat_of forbidden) - before))
sim stats | sed 's/^/# with owserver: /'
kill $server
wait $server 2>/dev/null
finish
