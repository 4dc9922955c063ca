/* SPDX-License-Identifier: MIT */
/* A directory on its way to a client: the gathered names, and the answer made of them. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/find.h"
#include "hal/owfs/frame.h"
#include "src/daemon/serve/directory.h"
#include "src/ground/signal/hash.h"

int buses_number(struct buses *buses, unsigned target, unsigned number)
{
	unsigned at = buses->count;

	for (unsigned i = 0; i < buses->count; i++)
		if (buses->bus[i].target == target && buses->bus[i].number == number)
			return (int)i;
	if (at < BUSES_MAX)
		buses->count++;
	else
		for (at = 0; at < BUSES_MAX && buses->bus[at].target != BUSES_NO_TARGET;)
			at++;
	if (at == BUSES_MAX)
		return -1;
	buses->bus[at].target = (uint8_t)target;
	buses->bus[at].number = (uint16_t)number;
	return (int)at;
}

void buses_renumber(struct buses *buses, const int *ports, unsigned count)
{
	for (unsigned i = 0; i < buses->count; i++) {
		unsigned before = buses->bus[i].target;

		buses->bus[i].target = BUSES_NO_TARGET;
		for (unsigned k = 0; k < count; k++)
			if (ports[k] == (int)before)
				buses->bus[i].target = (uint8_t)k;
	}
}

int buses_parse(const char *name, unsigned len)
{
	int number = 0;

	if (len < 5 || len > 8 || memcmp(name, "bus.", 4) != 0)
		return -1;
	for (unsigned i = 4; i < len; i++) {
		if (name[i] < '0' || name[i] > '9')
			return -1;
		number = number * 10 + (name[i] - '0');
	}
	return number;
}

/* The entries of the root beside devices and buses, in the order of owserver. */
static const char *const in_root[] = {"uncached",   "settings",  "system",
                                      "statistics", "structure", "simultaneous",
                                      "alarm",      "signals",   NULL};
#define IN_UNCACHED 1 /* the entries from here on are in /uncached too */

void directory_begin(struct directory *directory)
{
	directory->len = directory->count = directory->flags = directory->mark =
		directory->out_len = 0;
}

uint8_t *directory_room(struct directory *directory, uint32_t *room)
{
	*room = DIRECTORY_RAW - directory->len;
	return (uint8_t *)directory->raw + directory->len;
}

/*
 * True: the directory had the name. The first target's names are added when a second one answers.
 */
static bool seen(struct directory *directory, uint32_t at, size_t len)
{
	const char *name = directory->raw + at;
	uint32_t h = (uint32_t)hash_text(HASH_BEGIN, name, len);

	for (unsigned i = 0; i < 64; i++) {
		uint32_t *slot = &directory->seen[(h + i) % DIRECTORY_SEEN];

		if (!*slot) {
			*slot = at + 1;
			return false;
		}
		if (strncmp(directory->raw + *slot - 1, name, len) == 0 &&
		    directory->raw[*slot - 1 + len] == '\n')
			return true;
	}
	return false;
}

static void remember_first(struct directory *directory)
{
	uint32_t at = 0;

	memset(directory->seen, 0, sizeof(directory->seen));
	while (at < directory->len) {
		const char *end = memchr(directory->raw + at, '\n', directory->len - at);
		size_t len = (size_t)(end - (directory->raw + at));

		seen(directory, at, len);
		at += (uint32_t)len + 1;
	}
}

/*
 * A target's root adds only its devices: the server adds all other entries of the root by itself.
 */
static bool keeps(const struct node *node, struct buses *buses, unsigned target, const char *name,
                  size_t len)
{
	int number = buses_parse(name, (unsigned)len);

	if (len == 0)
		return false;
	if (!node->root)
		return true;
	if (number >= 0)
		buses_number(buses, target, (unsigned)number);
	return number < 0 && !node_is_in(in_root, name, len);
}

void directory_take(struct directory *directory, const struct node *node, struct buses *buses,
                    unsigned target, uint32_t len)
{
	char *from = directory->raw + directory->len, *end = from + len;
	bool others = directory->len != 0;

	if (others && directory->mark == 0)
		remember_first(directory);
	directory->mark = directory->len;
	while (from < end) {
		char *stop = memchr(from, '\n', (size_t)(end - from)), *name;
		uint32_t at = directory->len;
		size_t n;

		if (!stop)
			break;
		for (name = stop; name > from && name[-1] != '/'; name--)
			;
		n = (size_t)(stop - name);
		if (keeps(node, buses, target, name, n)) {
			memmove(directory->raw + at, name, n + 1);
			if (!others || !seen(directory, at, n)) {
				directory->len += (uint32_t)n + 1;
				directory->count++;
			}
		}
		from = stop + 1;
	}
}

bool directory_add(struct directory *directory, const char *name, size_t len)
{
	if (len + 1 > DIRECTORY_RAW - directory->len)
		return false;
	memcpy(directory->raw + directory->len, name, len);
	directory->raw[directory->len + len] = '\n';
	directory->len += (uint32_t)len + 1;
	directory->count++;
	return true;
}

void directory_add_once(struct directory *directory, const char *name)
{
	size_t len = strlen(name);

	for (uint32_t at = 0; at < directory->len; at++) {
		const char *there = directory->raw + at;
		const char *end = memchr(there, '\n', directory->len - at);

		if ((size_t)(end - there) == len && memcmp(there, name, len) == 0)
			return;
		at = (uint32_t)(end - directory->raw);
	}
	directory_add(directory, name, len);
}

/* --- The answer ------------------------------------------------------------------------------- */

static bool directory_put(struct directory *directory, const void *bytes, size_t len)
{
	if (len > DIRECTORY_OUT - directory->out_len)
		return false;
	memcpy(directory->out + directory->out_len, bytes, len);
	directory->out_len += (uint32_t)len;
	return true;
}

static bool put_header(struct directory *directory, const struct directory_form *form,
                       uint32_t payload, uint32_t size, uint32_t flags)
{
	struct frame_header h = {.payload = (int32_t)payload,
	                         .flags = form->flags,
	                         .size = (int32_t)size,
	                         .offset = (int32_t)flags};
	uint8_t bytes[FRAME_HEADER];

	frame_put_header(bytes, &h);
	return directory_put(directory, bytes, sizeof(bytes));
}

/* Write a device's name in the format that the client wants, and other names unchanged. */
static size_t as_asked(struct directory *directory, const struct directory_form *form,
                       const char **name, size_t len, char text[ROM_TEXT_MAX])
{
	uint32_t format = FRAME_FORMAT(form->flags);
	uint8_t rom[ROM_LEN];

	if (!form->node->devices || rom_parse(*name, len, rom))
		return len;
	/* owserver has none for a list of alarms */
	if (strcmp(form->node->path, "/alarm") != 0)
		directory->flags |= family_of(rom[0])->flags;
	*name = text;
	return (size_t)rom_print(rom, format > ROM_FIC ? ROM_F_I : (enum rom_format)format, text);
}

static bool put_name(struct directory *directory, const struct directory_form *form,
                     const char *name, size_t len)
{
	bool slash = form->slash && node_is_directory(form->node, name, len);
	bool root = form->prefix_len && form->prefix[0] != '/';
	char text[ROM_TEXT_MAX];
	uint32_t size;

	len = as_asked(directory, form, &name, len, text);
	size = (uint32_t)(root + form->prefix_len + 1 + len + slash);
	if (form->frames && !put_header(directory, form, size + 1, size, 0))
		return false;
	return directory_put(directory, "/", root) &&
	       directory_put(directory, form->prefix, form->prefix_len) &&
	       directory_put(directory, "/", 1) && directory_put(directory, name, len) &&
	       directory_put(directory, "/", slash) &&
	       directory_put(directory, form->frames ? "" : ",", 1);
}

static bool directory_end(struct directory *directory, const struct directory_form *form)
{
	uint32_t len = directory->out_len, payload = len - FRAME_HEADER;
	bool ok;

	if (form->frames)
		return put_header(directory, form, 0, 0, directory->flags);
	if (payload)
		directory->out[len - 1] = '\0'; /* the NUL replaces the last comma */
	directory->out_len = 0;
	ok = put_header(directory, form, payload, payload ? payload - 1 : 0, directory->flags);
	directory->out_len = len;
	return ok;
}

int directory_form(struct directory *directory, const struct directory_form *form)
{
	bool ok;
	uint32_t at = 0;

	directory->out_len = directory->flags = 0;
	/* the header of a DIRALL states the length of the names: it is written again at the end */
	ok = form->frames || put_header(directory, form, 0, 0, 0);
	while (ok && at < directory->len) {
		const char *name = directory->raw + at;
		const char *stop = memchr(name, '\n', directory->len - at);

		ok = put_name(directory, form, name, (size_t)(stop - name));
		at += (uint32_t)(stop - name) + 1;
	}
	return ok && directory_end(directory, form) ? 0 : -EMSGSIZE;
}

void directory_add_rest(struct directory *directory, const struct node *node,
                        const struct buses *buses)
{
	char name[16];

	for (unsigned i = 0; i < buses->count; i++)
		if (buses->bus[i].target != BUSES_NO_TARGET)
			directory_add(directory, name,
			              (size_t)snprintf(name, sizeof(name), "bus.%u", i));
	for (int i = node->uncached ? IN_UNCACHED : 0; in_root[i]; i++)
		directory_add(directory, in_root[i], strlen(in_root[i]));
}
