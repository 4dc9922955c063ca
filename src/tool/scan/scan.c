/* SPDX-License-Identifier: MIT */
/* Asks a target for its devices and their properties. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/find.h"
#include "hal/owfs/path.h"
#include "src/faces/show/text.h"
#include "src/tool/scan/scan.h"
#include "src/tool/scan/target.h"

/* --- What most people want of a device ------------------------------------------------------- */

/* In periods of 0.1 s: measurements once a second, contacts in each period. */
#define MEASURED 10

static enum ows_type property_type(const struct property *row, const char *name)
{
	switch ((enum property_type)row->type) {
	case PROPERTY_FLOAT:
	case PROPERTY_PRESSURE:
	case PROPERTY_TEMPERATURE:
	case PROPERTY_TEMPGAP:
		return OWS_DOUBLE;
	case PROPERTY_INTEGER:
		return OWS_LONG;
	case PROPERTY_UNSIGNED:
		return row->measures.least < 0 ? OWS_LONG : OWS_DWORD;
	case PROPERTY_ALIAS:
	case PROPERTY_ASCII:
	case PROPERTY_BINARY:
	case PROPERTY_BITS:
	case PROPERTY_DATE:
	case PROPERTY_DIRECTORY:
	case PROPERTY_YESNO:
		break;
	}
	return strstr(name, ".BYTE") ? OWS_BYTE : OWS_BOOL;
}

static const struct property *row_of(const struct family *family, const struct family_scan *scan)
{
	return family_property(family, NULL, scan->name, strcspn(scan->name, "."));
}

/* Does only a list of the chip's properties show whether it has this one? */
static bool is_of_a_kind(const struct family_scan *scan, const struct property *row)
{
	return row->kinds && strchr(scan->name, '/');
}

static bool asks_for_list(const struct scan_device *device)
{
	const struct family *family = family_of(device->family);

	for (const struct family_scan *scan = family->scan; scan && scan->name; scan++)
		if (is_of_a_kind(scan, row_of(family, scan)))
			return true;
	return false;
}

/* An element of an array, where the name means each of them. */
static void set_element(struct scan_property *property, const struct property *row, unsigned i)
{
	size_t name = strlen(property->name), word = strlen(property->word);
	bool letters = row->array.index == INDEX_LETTERS;
	char element[12];

	snprintf(element, sizeof(element), letters ? "%c" : "%u", letters ? 'A' + i : i);
	snprintf(property->name + name, sizeof(property->name) - name, ".%s", element);
	element[0] = (char)(element[0] | 0x20); /* digits stay */
	snprintf(property->word + word, sizeof(property->word) - word, "_%s", element);
}

static void set_property(struct scan_property *property, const struct family_scan *scan,
                         const struct property *row)
{
	enum ows_type type = property_type(row, scan->name);

	/* a number is set by who knows what it does: amphours, a wiper */
	*property = (struct scan_property){
		.type = type,
		.output = row->access & ACCESS_WRITE && (type == OWS_BOOL || type == OWS_BYTE),
		.per_factor = type == OWS_DOUBLE || row->measures.unit[0] ? MEASURED : 0};
	snprintf(property->name, sizeof(property->name), "%s", scan->name);
	snprintf(property->word, sizeof(property->word), "%s", scan->word);
}

bool scan_property(const struct scan_device *device, unsigned i, struct scan_property *property)
{
	const struct family *family = family_of(device->family);
	const struct family_scan *scan = family->scan;

	for (unsigned n = 0; scan && scan->name; n++, scan++) {
		const struct property *row = row_of(family, scan);
		bool each = row && row->array.count && !strchr(scan->name, '.');
		unsigned count = each ? row->array.count : 1;

		if (!row || (is_of_a_kind(scan, row) && !(device->has >> n & 1)))
			continue;
		if (i < count) {
			set_property(property, scan, row);
			if (each)
				set_element(property, row, i);
			return true;
		}
		i -= count;
	}
	return false;
}

const char *scan_identity(uint8_t code)
{
	static const char identity[] = "identity";
	const struct family *family = family_of(code);

	return family_property(family, NULL, identity, strlen(identity)) ? identity : family->model;
}

#define LISTING_MAX (256u * 1024)
#define BUSES_MAX 256
#define COUPLER 0x1f /* DS2409 */
#define COUPLERS_MAX 512
#define SEARCHES 3
#define DEVICE_LIST 8192

/* The requests for a device besides those for the properties of its kind. */
enum { ASK_TYPE, ASK_ALIAS, ASK_IDENTITY, ASK_PROPERTIES, ASKS = ASK_PROPERTIES + SCAN_PROPERTIES };

struct question {
	char path[192];
	char text[128];
};

static int by_path(const void *a, const void *b)
{
	const struct scan_device *x = a, *y = b;

	return strcmp(x->path, y->path);
}

/* List path into text (LISTING_MAX + 1 bytes). Returns the error. */
static int scan_list(struct target *target, const char *path, bool fresh, char *text)
{
	struct ask ask = {.req = {.op = BUS_DIR,
	                          .prio = BUS_GUEST,
	                          .path = path,
	                          .fresh = fresh,
	                          .data = (uint8_t *)text,
	                          .len = LISTING_MAX}};
	int err = target_ask_one(target, &ask);

	text[err ? 0 : ask.answer.len] = '\0';
	return err;
}

/* Parse the device of a line; false if the line shows none. */
bool scan_device_of(const char *line, struct scan_device *device)
{
	char rom[ROM_TEXT_MAX];
	struct path path;

	if (path_split(line, strlen(line), &path) || !path.has_rom || path.property.len)
		return false;
	rom_print(path.rom, ROM_F_I, rom);
	*device = (struct scan_device){.family = path.rom[0]};
	int way = (int)(path.last.text - path.device.text);
	int n = snprintf(device->path, sizeof(device->path), "/%.*s%s", way, path.device.text, rom);
	return n >= 0 && (size_t)n < sizeof(device->path);
}

/* Room for one more. It is doubled where the count is a power of two: 40,000 move a few times. */
static bool room_for_device(struct scan *scan)
{
	size_t room = scan->count ? 2 * (size_t)scan->count : 1;
	struct scan_device *more;

	if (scan->count & (scan->count - 1))
		return true;
	more = realloc(scan->device, room * sizeof(*more));
	if (more)
		scan->device = more;
	return more != NULL;
}

/* The devices of a listing. */
static int parse_list(struct scan *scan, char *text)
{
	struct scan_device device;
	char *rest;

	for (char *line = strtok_r(text, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
		if (!scan_device_of(line, &device))
			continue;
		if (!room_for_device(scan))
			return -ENOMEM;
		scan->device[scan->count++] = device;
	}
	return 0;
}

/* Was a coupler of this id found before, on another way? */
static bool is_found_before(const struct scan *scan, unsigned i)
{
	const char *id = strrchr(scan->device[i].path, '/');

	for (unsigned n = 0; n < i; n++)
		if (scan->device[n].family == COUPLER &&
		    strcmp(strrchr(scan->device[n].path, '/'), id) == 0)
			return true;
	return false;
}

/*
 * What is behind the couplers that were found, and behind those that are found there. Each is
 * looked behind once, so a server that shows one behind itself leads nowhere.
 */
static int find_behind(struct target *target, struct scan *scan, char *text)
{
	static const char *const branches[] = {"main", "aux"};
	char path[sizeof(scan->device->path) + 8];
	unsigned couplers = 0;
	int err = 0;

	for (unsigned i = 0; i < scan->count && !err; i++) {
		if (scan->device[i].family != COUPLER || is_found_before(scan, i))
			continue;
		if (++couplers > COUPLERS_MAX)
			return -E2BIG;
		for (unsigned n = 0; n < 2 && !err; n++) {
			snprintf(path, sizeof(path), "%s/%s", scan->device[i].path, branches[n]);
			if (scan_list(target, path, true, text) == 0)
				err = parse_list(scan, text);
		}
	}
	return err;
}

/* A search that is disturbed again and again is no reason to show nothing. */
static int list_all(struct target *target, struct scan *scan, char *text)
{
	int err = -EBADMSG;

	for (unsigned try = 0; try < SEARCHES && err == -EBADMSG; try++)
		err = scan_list(target, "/", true, text);
	scan->disturbed = err == -EBADMSG;
	return scan->disturbed ? scan_list(target, "/", false, text) : err;
}

static int find_all(struct target *target, struct scan *scan, char *text)
{
	unsigned kept = 0;
	int err = list_all(target, scan, text);

	if (!err)
		err = parse_list(scan, text);
	if (!err)
		err = find_behind(target, scan, text);
	if (err || !scan->count)
		return err;
	qsort(scan->device, scan->count, sizeof(*scan->device), by_path);
	for (unsigned i = 1; i < scan->count; i++)
		if (by_path(&scan->device[kept], &scan->device[i]))
			scan->device[++kept] = scan->device[i];
	scan->count = kept + 1;
	return 0;
}

/* Find the bus of each device on a wire itself; buses are numbered without gaps. */
static void locate_devices(struct target *target, struct scan *scan, char *text)
{
	char path[16], *rest;

	for (unsigned bus = 0; scan->count && bus < BUSES_MAX; bus++) {
		snprintf(path, sizeof(path), "/bus.%u", bus);
		if (scan_list(target, path, false, text))
			return;
		for (char *line = strtok_r(text, "\n", &rest); line;
		     line = strtok_r(NULL, "\n", &rest)) {
			struct scan_device key, *found;

			if (!scan_device_of(line, &key))
				continue;
			found = bsearch(&key, scan->device, scan->count, sizeof(key), by_path);
			if (found)
				snprintf(found->location, sizeof(found->location), "%s", path + 1);
		}
	}
}

/* NULL: not asked. *output: see scan_property. */
static const char *property_of(const struct scan_device *device, unsigned ask, bool *output,
                               struct scan_property *property)
{
	*output = false;
	if (ask == ASK_TYPE)
		return "type";
	if (ask == ASK_ALIAS)
		return "alias";
	if (ask == ASK_IDENTITY)
		return scan_identity(device->family);
	if (!scan_property(device, ask - ASK_PROPERTIES, property))
		return NULL;
	*output = property->output;
	return property->name;
}

/* The type was asked for before it was known which chip it is. */
static void correct_type(struct scan_device *device)
{
	size_t len = strcspn(device->identity, " ");

	if (len && len < sizeof(device->type) && strcmp(device->identity, "unknown") != 0)
		snprintf(device->type, sizeof(device->type), "%.*s", (int)len, device->identity);
}

static void take_answer(struct scan_device *device, unsigned n, struct ask *ask, char *text)
{
	struct scan_value *value;
	size_t len = ask->answer.err ? 0 : target_unpad(text, ask->answer.len);

	if (n == ASK_TYPE) {
		device->simulated = ask->answer.detail & BUS_DETAIL_SIMULATED;
		text_clean(text, len, sizeof(device->type), device->type, sizeof(device->type));
	} else if (n == ASK_ALIAS) {
		text_clean(text, len, sizeof(device->alias), device->alias, sizeof(device->alias));
	} else if (n == ASK_IDENTITY) {
		text_clean(text, len, sizeof(device->identity), device->identity,
		           sizeof(device->identity));
		correct_type(device);
	} else {
		value = &device->value[n - ASK_PROPERTIES];
		value->err = ask->answer.err;
		value->refused = ask->answer.number;
		text_clean(text, len, sizeof(value->text), value->text, sizeof(value->text));
	}
}

/* What is in the list of a device decides which rows of its family it has. */
static void take_kind(struct scan_device *device, const struct ask *ask)
{
	const struct family_scan *scan = family_of(device->family)->scan;
	const char *list = (const char *)ask->req.data;
	char entry[PROPERTY_NAME_ROOM + 2];

	device->err = ask->answer.err;
	for (unsigned n = 0; scan[n].name && !device->err; n++) {
		int len = snprintf(entry, sizeof(entry), "/%.*s", (int)strcspn(scan[n].name, "/"),
		                   scan[n].name);
		const char *at = memmem(list, ask->answer.len, entry, (size_t)len);

		for (; at; at = strstr(at + 1, entry))
			if (!at[len] || at[len] == '\n' || at[len] == '/')
				device->has |= UINT64_C(1) << n;
	}
}

/* Where the chips of a family differ: list what each has. 0, -ENOMEM or -ETIMEDOUT. */
static int find_kinds(struct target *target, struct scan_device *devices, unsigned device_count)
{
	char(*lists)[DEVICE_LIST];
	struct ask *asks;
	unsigned count = 0;

	for (unsigned i = 0; i < device_count; i++)
		count += asks_for_list(&devices[i]);
	if (!count)
		return 0;
	lists = calloc(count, sizeof(*lists));
	asks = calloc(count, sizeof(*asks));
	if (!lists || !asks) {
		free(lists);
		free(asks);
		return -ENOMEM;
	}
	count = 0;
	for (unsigned i = 0; i < device_count; i++) {
		if (!asks_for_list(&devices[i]))
			continue;
		asks[count].req = (struct bus_req){.op = BUS_DIR,
		                                   .prio = BUS_GUEST,
		                                   .path = devices[i].path,
		                                   .data = (uint8_t *)lists[count],
		                                   .len = sizeof(*lists) - 1};
		count++;
	}
	target_ask(target, asks, count);
	count = 0;
	for (unsigned i = 0; i < device_count; i++)
		if (asks_for_list(&devices[i]))
			take_kind(&devices[i], &asks[count++]);
	free(lists);
	free(asks);
	return target->dead ? -ETIMEDOUT : 0;
}

int scan_read(struct target *target, struct scan_device *devices, unsigned device_count, bool fresh)
{
	size_t room = (size_t)device_count * ASKS;
	struct question *questions = calloc(room + 1, sizeof(*questions));
	struct ask *asks = calloc(room + 1, sizeof(*asks));
	struct scan_property property;
	unsigned count = 0;
	bool output;
	int err = questions && asks ? find_kinds(target, devices, device_count) : -ENOMEM;

	if (err) {
		free(questions);
		free(asks);
		return err;
	}
	for (unsigned i = 0; i < room; i++) {
		struct scan_device *device = &devices[i / ASKS];
		const char *name = property_of(device, i % ASKS, &output, &property);
		struct question *question = &questions[count];

		if (!name)
			continue;
		snprintf(question->path, sizeof(question->path), "%s/%s", device->path, name);
		asks[count++].req = (struct bus_req){.op = BUS_READ,
		                                     .prio = BUS_GUEST,
		                                     .path = question->path,
		                                     .fresh = output ||
		                                              (fresh && i % ASKS >= ASK_PROPERTIES),
		                                     .data = (uint8_t *)question->text,
		                                     .len = sizeof(question->text)};
	}
	target_ask(target, asks, count);
	count = 0;
	for (unsigned i = 0; i < room; i++)
		if (property_of(&devices[i / ASKS], i % ASKS, &output, &property)) {
			take_answer(&devices[i / ASKS], i % ASKS, &asks[count],
			            questions[count].text);
			count++;
		}
	/*
	 * A dead target is not stepped again, so the bus writes no more to the memory freed here.
	 */
	free(questions);
	free(asks);
	return target->dead ? -ETIMEDOUT : 0;
}

int scan_find(struct target *target, struct scan *scan)
{
	char *text = malloc(LISTING_MAX + 1);
	int err;

	*scan = (struct scan){0};
	if (!text)
		return -ENOMEM;
	err = find_all(target, scan, text);
	if (!err)
		locate_devices(target, scan, text);
	free(text);
	return err;
}

void scan_free(struct scan *scan)
{
	free(scan->device);
}
