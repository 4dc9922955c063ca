/* SPDX-License-Identifier: MIT */
/* OWFS paths and device ids: parsed, printed, split and compared. */
#include <errno.h>
#include <string.h>
#include <strings.h>

#include "hal/owfs/path.h"

uint8_t rom_crc8(const uint8_t *data, size_t len)
{
	/* what four bits add: x^8 + x^5 + x^4 + 1, the low bit first */
	static const uint8_t four[16] = {0x00, 0x9d, 0x23, 0xbe, 0x46, 0xdb, 0x65, 0xf8,
	                                 0x8c, 0x11, 0xaf, 0x32, 0xca, 0x57, 0xe9, 0x74};
	uint8_t crc = 0;

	while (len--) {
		crc ^= *data++;
		crc = crc >> 4 ^ four[crc & 0xf];
		crc = crc >> 4 ^ four[crc & 0xf];
	}
	return crc;
}

/* Where the dots are, as positions in the text; what is left are 14 or 16 hex digits. */
static const struct {
	uint8_t len, dot, dot2;
} forms[] = {
	[ROM_F_I] = {15, 2, 0},  [ROM_FI] = {14, 0, 0},    [ROM_F_I_C] = {18, 2, 15},
	[ROM_F_IC] = {17, 2, 0}, [ROM_FI_C] = {17, 14, 0}, [ROM_FIC] = {16, 0, 0},
};
#define FORMS (sizeof(forms) / sizeof(forms[0]))

int hex_digit(char c)
{
	if (c >= '0' && c <= '9')
		return c - '0';
	if (c >= 'A' && c <= 'F')
		return c - 'A' + 10;
	if (c >= 'a' && c <= 'f')
		return c - 'a' + 10;
	return -1;
}

/* Returns the number of bytes, 0 if the text has not this form. */
static int form_parse(size_t form, const char *text, size_t len, uint8_t rom[ROM_LEN])
{
	int digits = 0;

	if (len != forms[form].len)
		return 0;
	for (size_t i = 0; i < len; i++) {
		bool dot = i && (i == forms[form].dot || i == forms[form].dot2);
		int digit = hex_digit(text[i]);

		if (dot ? text[i] != '.' : digit < 0)
			return 0;
		if (dot)
			continue;
		rom[digits / 2] = (uint8_t)(digits & 1 ? rom[digits / 2] << 4 | digit : digit);
		digits++;
	}
	return digits / 2;
}

int rom_parse(const char *text, size_t len, uint8_t rom[ROM_LEN])
{
	uint8_t raw[ROM_LEN] = {0}, crc;
	int bytes = 0;

	for (size_t form = 0; form < FORMS && !bytes; form++)
		bytes = form_parse(form, text, len, raw);
	if (!bytes)
		return -EINVAL;
	crc = rom_crc8(raw, ROM_LEN - 1);
	if (bytes == ROM_LEN - 1)
		raw[ROM_LEN - 1] = crc;
	if (!raw[0] || raw[ROM_LEN - 1] != crc)
		return -EBADMSG;
	memcpy(rom, raw, ROM_LEN);
	return 0;
}

int rom_print(const uint8_t rom[ROM_LEN], enum rom_format format, char text[ROM_TEXT_MAX])
{
	static const char hex[] = "0123456789ABCDEF";
	int digits = 0;

	for (int i = 0; i < forms[format].len; i++) {
		if (i && (i == forms[format].dot || i == forms[format].dot2)) {
			text[i] = '.';
			continue;
		}
		text[i] = hex[digits & 1 ? rom[digits / 2] & 0xf : rom[digits / 2] >> 4];
		digits++;
	}
	text[forms[format].len] = '\0';
	return forms[format].len;
}

/* As owserver compares the words that stand where a device may. */
static bool slice_is(struct path_slice slice, const char *word)
{
	return slice.len == strlen(word) && !strncasecmp(slice.text, word, slice.len);
}

bool path_is_branch(struct path_slice slice)
{
	return (slice.len == 4 && !memcmp(slice.text, "main", 4)) ||
	       (slice.len == 3 && !memcmp(slice.text, "aux", 3));
}

static bool slice_in(struct path_slice slice, const char *const *words)
{
	for (; *words; words++)
		if (slice_is(slice, *words))
			return true;
	return false;
}

/* The entries that OWFS has beside the devices, in the root and below a coupler. */
static const char *const no_device[] = {"simultaneous", "settings",  "statistics", "structure",
                                        "system",       "interface", NULL};
#define DS2409_FAMILY 0x1f

/* The component at *pos; moves *pos past the component and its slash. */
static struct path_slice component(const char *text, size_t len, size_t *pos)
{
	struct path_slice slice = {text + *pos, 0};
	const char *slash = memchr(slice.text, '/', len - *pos);

	slice.len = slash ? (size_t)(slash - slice.text) : len - *pos;
	*pos += slice.len + (slash != NULL);
	return slice;
}

static const char *text_fault(const char *text, size_t len)
{
	size_t pos = 0;

	if (len > PATH_LEN_MAX)
		return "is longer than 255 bytes";
	for (size_t i = 0; i < len; i++)
		if ((unsigned char)text[i] < ' ' || text[i] == 0x7f)
			return "holds a control character";
	if (len && *text == '/')
		pos = 1;
	if (pos == len)
		return NULL;
	if (text[len - 1] == '/')
		return "has an empty component";
	while (pos < len) {
		struct path_slice part = component(text, len, &pos);

		if (!part.len)
			return "has an empty component";
		if (slice_is(part, ".") || slice_is(part, ".."))
			return "has a component \".\" or \"..\"";
	}
	return NULL;
}

/* N of "bus.N", -1 if it is something else. */
static int bus_number(struct path_slice part)
{
	int number = 0;

	if (part.len < 5 || part.len > 8 || strncasecmp(part.text, "bus.", 4))
		return -1;
	for (size_t i = 4; i < part.len; i++) {
		if (part.text[i] < '0' || part.text[i] > '9')
			return -1;
		number = number * 10 + (part.text[i] - '0');
	}
	return number;
}

static bool parse_flag(struct path_slice part, struct path *path)
{
	int bus = bus_number(part);

	if (slice_is(part, "uncached"))
		path->uncached = true;
	else if (slice_is(part, "alarm"))
		path->alarm = true;
	else if (bus >= 0)
		path->bus = bus;
	else if (!slice_is(part, "text") && !slice_is(part, "json"))
		return false;
	return true;
}

/* Take part as the last component of the device. -EBADMSG as rom_parse(). */
static int parse_device(struct path_slice part, struct path *path)
{
	int err = rom_parse(part.text, part.len, path->rom);

	if (err == -EBADMSG)
		return err;
	path->has_rom = !err;
	path->last = part;
	if (!path->device.len)
		path->device.text = part.text;
	path->device.len = (size_t)(part.text + part.len - path->device.text);
	return 0;
}

/*
 * Is the part after main or aux of a coupler a device? Of an alias only the part after it can show.
 */
static bool leads_on(const struct path *path, struct path_slice branch, struct path_slice next)
{
	uint8_t rom[ROM_LEN];

	if (!next.len || !path_is_branch(branch) || slice_in(next, no_device))
		return false;
	if (path->has_rom)
		return path->rom[0] == DS2409_FAMILY;
	return rom_parse(next.text, next.len, rom) != -EINVAL;
}

const char *path_split(const char *text, size_t len, struct path *path)
{
	const char *fault = text_fault(text, len);
	struct path_slice part = {text, 0};
	size_t pos = len && *text == '/', here = pos;

	if (fault)
		return fault;
	memset(path, 0, sizeof(*path));
	path->bus = -1;
	while (here < len) {
		pos = here;
		part = component(text, len, &pos);
		if (!parse_flag(part, path))
			break;
		here = pos;
	}
	while (here < len && !slice_in(part, no_device)) {
		struct path_slice next;

		if (parse_device(part, path))
			return "has a device id with a wrong checksum";
		here = pos;
		if (here == len)
			break;
		part = component(text, len, &pos);
		if (pos == len && here + part.len == len)
			break;
		next = component(text, len, &pos);
		if (!leads_on(path, part, next))
			break;
		part = next;
	}
	path->property.text = text + here;
	path->property.len = len - here;
	return NULL;
}

bool path_same_device(const struct path *a, const struct path *b)
{
	if (!a->last.len || !b->last.len || a->has_rom != b->has_rom)
		return false;
	if (a->has_rom)
		return !memcmp(a->rom, b->rom, ROM_LEN);
	return a->last.len == b->last.len && !memcmp(a->last.text, b->last.text, a->last.len);
}
