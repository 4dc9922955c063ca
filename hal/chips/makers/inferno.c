/* SPDX-License-Identifier: MIT */
/*
 * Soft devices of Inferno Embedded. Their answers are read AREA_LOOKS times; what a command does is
 * proved by the device's own answer, for it checks the command.
 */
#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/format.h"
#include "hal/chips/makers/inferno.h"
#include "hal/wire/crc.h"

#define PORTS 8
#define CHANNELS 32
#define ARGS 8
#define BOOT_NS (1000 * TXN_MS)

enum { BOOT_UPDATER = 0xfc, DEVICE = 0xff };
enum { SET_LIGHT = 0x03, GET_LIGHT, COMMIT };
enum { BOOTLOADER_SIZE = 0x00, RANGE = 0x04 };
enum { COUNT_SWITCHES = 0x01, COUNT_LEDS, COUNT_RELAYS, SET_TYPE, GET_ACTIVATED = 0x06 };

struct inferno {
	uint8_t counts[3][2]; /* switches, LEDs, relays: ports, channels; 0: not known */
	int64_t fetched_ns;   /* when the device gave the activations; 0: it has not yet */
	uint32_t activated[PORTS];
};
_Static_assert(sizeof(struct inferno) <= DEVICE_OWN, "no room for what is known");

/* From call to call. */
struct asked {
	uint8_t looks, stage, channel;
	uint8_t seen[CHANNELS];
};

static AREA_NAMED(identification, "device", .size = 4, .block = 4, .read = DEVICE);

static struct inferno *inferno_of(const struct txn *txn)
{
	return txn->device->own;
}

int inferno_identify(struct txn *txn)
{
	uint8_t bytes[4];
	int err = area_read(txn, &identification, 0, bytes, sizeof(bytes));

	if (err)
		return err;
	if (bytes[3] == 0xff)
		return -EBADMSG;
	bool known = bytes[0] > 0 && bytes[0] < INFERNO_OTHER && !bytes[1];
	txn->device->kind = known ? bytes[0] : INFERNO_OTHER;
	return 0;
}

/*
 * The command, its n bytes and their checksum; the device answers 0 and in_n bytes. These are read
 * at once: on a wire with other masters only the answer proves that the bytes after it are its own.
 */
static int inferno_exchange(struct txn *txn, uint8_t code, const uint8_t *args, unsigned n,
                            uint8_t *in, unsigned in_n)
{
	uint8_t bytes[8 + 1 + ARGS + 1], answer[1 + PORTS * CHANNELS];
	int err;

	memcpy(bytes, txn->device->rom, 8);
	bytes[8] = code;
	if (n)
		memcpy(bytes + 9, args, n);
	bytes[9 + n] = onewire_crc8(bytes, 9 + n);
	err = txn_command(txn, bytes + 8, 2 + n);
	if (err || code == BOOT_UPDATER)
		return err;
	err = txn_read(txn, answer, 1 + in_n);
	if (err)
		return err;
	if (in_n)
		memcpy(in, answer + 1, in_n);
	return answer[0] ? -EBADMSG : 0;
}

static int inferno_send(struct txn *txn, uint8_t code, const uint8_t *args, unsigned n)
{
	return inferno_exchange(txn, code, args, n, NULL, 0);
}

/* The n bytes of the answer after `skip`, to asked->seen; TXN_MORE until enough looks agree. */
static int inferno_ask(struct txn *txn, uint8_t code, const uint8_t *args, unsigned args_n,
                       unsigned skip, unsigned n)
{
	struct asked *asked = txn_own(txn, struct asked);
	uint8_t in[PORTS * CHANNELS];
	int err = skip + n > sizeof(in) ? -EIO
	                                : inferno_exchange(txn, code, args, args_n, in, skip + n);

	if (err)
		return err;
	if (asked->looks && memcmp(asked->seen, in + skip, n) != 0)
		return -EBADMSG;
	memcpy(asked->seen, in + skip, n);
	if (++asked->looks < AREA_LOOKS)
		return TXN_MORE;
	asked->looks = 0;
	return 0;
}

/* 0: it is known how many ports and channels there are of it. */
static int inferno_count(struct txn *txn, unsigned which)
{
	const struct asked *asked = txn_own(txn, struct asked);
	uint8_t *counts = inferno_of(txn)->counts[which];

	if (counts[0])
		return 0;
	int err = inferno_ask(txn, (uint8_t)(COUNT_SWITCHES + which), NULL, 0, 0, 2);
	if (err)
		return err;
	if (!asked->seen[0] || asked->seen[1] > CHANNELS)
		return -EIO;
	memcpy(counts, asked->seen, 2);
	return TXN_MORE;
}

static unsigned what_of(const struct txn *txn)
{
	return (unsigned)txn->property->arg >> 8;
}

static unsigned port_of(const struct txn *txn)
{
	return (unsigned)txn->property->arg & 0xff;
}

/* State, mode and timeout are the relays'. */
static unsigned counted(const struct txn *txn)
{
	return what_of(txn) < INFERNO_STATE ? what_of(txn) : INFERNO_STATE;
}

int inferno_read_count(struct txn *txn)
{
	static const uint8_t none;
	const struct asked *asked = txn_own(txn, struct asked);
	int err;

	if (txn->device->kind == INFERNO_LIGHTS) {
		err = inferno_ask(txn, 0x02, &none, 0, 0, 1);
		txn->number[0] = asked->seen[0];
		return err;
	}
	err = inferno_count(txn, counted(txn));
	txn->number[0] = inferno_of(txn)->counts[counted(txn)][port_of(txn)];
	return err;
}

static int put_list(struct txn *txn, const uint8_t *values, unsigned n)
{
	char text[4 * CHANNELS + 1] = "";
	size_t len = 0;

	for (unsigned i = 0; i < n; i++)
		len += (size_t)snprintf(text + len, sizeof(text) - len, "%s%u", i ? "," : "",
		                        values[i]);
	return property_text(txn, text);
}

static int put_bits(struct txn *txn, uint32_t bits, unsigned n)
{
	uint8_t values[CHANNELS];

	for (unsigned i = 0; i < n; i++)
		values[i] = bits >> i & 1;
	return put_list(txn, values, n);
}

int inferno_read_port(struct txn *txn)
{
	static const uint8_t codes[] = {0, 0x08, 0x0c, 0x0d, 0x0e};
	const struct asked *asked = txn_own(txn, struct asked);
	const uint8_t port = (uint8_t)port_of(txn);
	uint32_t bits = 0;
	int err = inferno_count(txn, counted(txn));

	if (err)
		return err;
	const uint8_t *counts = inferno_of(txn)->counts[counted(txn)];
	unsigned n = counts[1], bytes = (n + 7) / 8;

	if (port >= counts[0])
		return -ENOENT;
	switch ((enum inferno_port)what_of(txn)) {
	case INFERNO_SWITCH:
		if (!inferno_of(txn)->fetched_ns)
			return -EIO;
		txn->measured_ns = inferno_of(txn)->fetched_ns;
		return put_bits(txn, inferno_of(txn)->activated[port], n);
	case INFERNO_LED:
		err = inferno_ask(txn, codes[INFERNO_LED], &port, 1, 0, bytes);
		for (unsigned i = 0; i < bytes && !err; i++)
			bits |= (uint32_t)asked->seen[i] << 8 * i;
		return err ? err : put_bits(txn, bits, n);
	case INFERNO_STATE:
	case INFERNO_MODE:
	case INFERNO_TIMEOUT:
		break;
	}
	err = inferno_ask(txn, codes[what_of(txn)], NULL, 0, port * n, n);
	return err ? err : put_list(txn, asked->seen, n);
}

/* Number i of the list that is written; -EINVAL: it is none, -ENOENT: the list has ended. */
static int list_number(const struct txn *txn, unsigned i, uint32_t most)
{
	const char *part;
	char text[16] = "", *end;
	size_t len;

	if (!list_part((const char *)txn->data, txn->len, i, &part, &len))
		return -ENOENT;
	if (len == 0 || len >= sizeof(text))
		return -EINVAL;
	memcpy(text, part, len);
	unsigned long value = strtoul(text, &end, 10);

	while (isspace((unsigned char)*end))
		end++;
	return *end || strchr(text, '-') || value > most ? -EINVAL : (int)value;
}

/* All numbers fit before one is sent; there are n at the most. */
static int check_list(const struct txn *txn, unsigned n, uint32_t most)
{
	unsigned i = 0;
	int value;

	while ((value = list_number(txn, i, most)) >= 0)
		i++;
	return txn->at || value != -ENOENT || i == 0 || i > n ? -EINVAL : 0;
}

/* Channel by channel, as many as the list has. */
int inferno_write_port(struct txn *txn)
{
	static const uint8_t codes[] = {0, 0x07, 0x0b, 0x09, 0x0a};
	struct asked *asked = txn_own(txn, struct asked);
	uint32_t most = what_of(txn) == INFERNO_LED ? 1 : 255;
	int value, err = inferno_count(txn, counted(txn));

	if (err)
		return err;
	const uint8_t *counts = inferno_of(txn)->counts[counted(txn)];

	if (port_of(txn) >= counts[0])
		return -ENOENT;
	if (asked->channel == 0 && check_list(txn, counts[1], most))
		return -EINVAL;
	value = list_number(txn, asked->channel, most);
	if (value < 0)
		return 0;
	const uint8_t args[] = {(uint8_t)port_of(txn), asked->channel, (uint8_t)value};

	err = inferno_send(txn, codes[what_of(txn)], args, sizeof(args));
	asked->channel++;
	return err ? err : TXN_MORE;
}

/* "port,channel,type" */
int inferno_set_type(struct txn *txn)
{
	int err = inferno_count(txn, INFERNO_SWITCH);

	if (err)
		return err;
	if (check_list(txn, 3, 255) || list_number(txn, 2, 3) < 0)
		return -EINVAL;
	const uint8_t args[] = {(uint8_t)list_number(txn, 0, 255),
	                        (uint8_t)list_number(txn, 1, 255), (uint8_t)list_number(txn, 2, 3)};
	const uint8_t *counts = inferno_of(txn)->counts[INFERNO_SWITCH];

	if (args[0] >= counts[0] || args[1] >= counts[1])
		return -EINVAL;
	return inferno_send(txn, SET_TYPE, args, sizeof(args));
}

/* It clears what it reads: it is read once, and nothing proves the bytes. */
int inferno_refresh(struct txn *txn)
{
	struct inferno *inferno = inferno_of(txn);
	uint8_t bytes[PORTS * 4];
	int err = inferno_count(txn, INFERNO_SWITCH);

	if (err || txn->number[0] == 0)
		return err;
	unsigned ports = inferno->counts[INFERNO_SWITCH][0];
	unsigned each = (inferno->counts[INFERNO_SWITCH][1] + 7u) / 8;

	ports = ports < PORTS ? ports : PORTS;
	err = inferno_exchange(txn, GET_ACTIVATED, NULL, 0, bytes, ports * each);
	if (err)
		return err;
	memset(inferno->activated, 0, sizeof(inferno->activated));
	for (unsigned i = 0; i < ports * each; i++)
		inferno->activated[i / each] |= (uint32_t)bytes[i] << 8 * (i % each);
	inferno->fetched_ns = txn_now(txn);
	return 0;
}

/* Red, green, blue, white, and the ms that its fade takes: it is read when that is over. */
int inferno_read_light(struct txn *txn)
{
	const uint8_t channel = (uint8_t)txn->property->arg;
	const struct asked *asked = txn_own(txn, struct asked);
	const uint8_t *in = asked->seen;
	char text[40];
	int err = inferno_ask(txn, GET_LIGHT, &channel, 1, 0, 7);

	if (err)
		return err;
	snprintf(text, sizeof(text), "%3d,%3d,%3d,%3d,%8d", in[0], in[1], in[2], in[3],
	         in[4] | in[5] << 8 | in[6] << 16);
	return property_text(txn, text);
}

int inferno_write_light(struct txn *txn)
{
	struct asked *asked = txn_own(txn, struct asked);
	uint8_t args[ARGS] = {(uint8_t)txn->property->arg};
	int fade, err;

	if (asked->stage)
		return inferno_send(txn, COMMIT, NULL, 0);
	fade = list_number(txn, 4, 0xffffff);
	if (fade < 0 || check_list(txn, 5, 0xffffff))
		return -EINVAL;
	for (unsigned i = 0; i < 4; i++) {
		if (list_number(txn, i, 255) < 0)
			return -EINVAL;
		args[1 + i] = (uint8_t)list_number(txn, i, 255);
	}
	for (unsigned i = 0; i < 3; i++)
		args[5 + i] = (uint8_t)(fade >> 8 * i);
	err = inferno_send(txn, SET_LIGHT, args, sizeof(args));
	asked->stage = 1;
	return err ? err : TXN_MORE;
}

int inferno_command(struct txn *txn)
{
	return txn->number[0] != 0 ? inferno_send(txn, (uint8_t)txn->property->arg, NULL, 0) : 0;
}

int inferno_read_device(struct txn *txn)
{
	static const char *const names[] = {
		[INFERNO_UNKNOWN] = "",
		[INFERNO_LIGHTS] = "Inferno Embedded RGBW Controller",
		[INFERNO_UPDATER] = "Inferno Embedded Firmware Updater",
		[INFERNO_SWITCHES] = "Inferno Embedded Switch Master",
		[INFERNO_OTHER] = "unknown",
	};

	return property_text(txn, names[txn->device->kind]);
}

/* It does not answer: the device that comes up shows it. */
int inferno_enter_update(struct txn *txn)
{
	struct asked *asked = txn_own(txn, struct asked);
	int err;

	if (txn->number[0] == 0)
		return 0;
	if (asked->stage == 0) {
		asked->stage = 1;
		memset(inferno_of(txn), 0, sizeof(struct inferno));
		err = inferno_send(txn, BOOT_UPDATER, NULL, 0);
		/* Also if this request ends here, the way out of the updater must stay open. */
		txn->device->kind = err ? INFERNO_UNKNOWN : INFERNO_UPDATER;
		return err ? err : txn_wait(txn, BOOT_NS);
	}
	err = inferno_identify(txn);
	if (err < 0)
		txn->device->kind = INFERNO_UNKNOWN;
	return err ? err : txn->device->kind == INFERNO_UPDATER ? 0 : -EIO;
}

int inferno_read_size(struct txn *txn)
{
	const struct asked *asked = txn_own(txn, struct asked);
	int err = inferno_ask(txn, BOOTLOADER_SIZE, NULL, 0, 0, 4);

	txn->number[0] = area_le32(asked->seen);
	return err;
}

int inferno_read_range(struct txn *txn)
{
	const struct asked *asked = txn_own(txn, struct asked);
	char text[40];
	int err = inferno_ask(txn, RANGE, NULL, 0, 0, 8);

	if (err)
		return err;
	snprintf(text, sizeof(text), "0x%08x,0x%08x", area_le32(asked->seen),
	         area_le32(asked->seen + 4));
	return property_text(txn, text);
}
