/* SPDX-License-Identifier: MIT */
/* The listing of a directory of an owserver, with each device under its id. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/owserver/listing.h"

#define KEEP_NS (10 * NS_PER_S)
#define ADDRESS_LEN 16

static const struct listing_name *known_name(const struct listing *listing, const char *alias,
                                             size_t len, int64_t now)
{
	for (unsigned i = 0; i < LISTING_NAMES; i++) {
		const struct listing_name *name = &listing->name[i];

		if (now < name->until_ns && strlen(name->alias) == len &&
		    memcmp(name->alias, alias, len) == 0)
			return name;
	}
	return NULL;
}

/* "2867C6697351FF68" to "28.67C6697351FF" */
static bool id_of_address(const uint8_t *address, uint32_t len, char id[ROM_TEXT_MAX])
{
	uint8_t rom[ROM_LEN];

	if (len != ADDRESS_LEN || rom_parse((const char *)address, len, rom))
		return false;
	rom_print(rom, ROM_F_I, id);
	return true;
}

/* Find the id of an alias. 0; 1: the name is no alias; or the error of talk_exchange(). */
static int find_id(struct listing *listing, struct talk *talk, const char *alias, size_t len,
                   int64_t deadline_ns, char id[ROM_TEXT_MAX])
{
	const struct bus_env *env = talk->connection.env;
	const struct listing_name *name = known_name(listing, alias, len, bus_now(env));
	struct listing_name *place = &listing->name[listing->next];
	char path[FRAME_PATH_MAX + 1];
	uint8_t address[ADDRESS_LEN];
	struct talk_request request = {.type = FRAME_READ,
	                               .path = path,
	                               .size = ADDRESS_LEN,
	                               .room = address,
	                               .limit = ADDRESS_LEN};
	int err;

	if (name) {
		memcpy(id, name->id, sizeof(name->id));
		return 0;
	}
	if (len + sizeof("//address") > sizeof(path))
		return 1;
	snprintf(path, sizeof(path), "/%.*s/address", (int)len, alias);
	err = talk_exchange(talk, &request, deadline_ns);
	if (err)
		return err;
	if (talk->reader.header.type < 0 ||
	    !id_of_address(address, (uint32_t)talk->reader.header.payload, id))
		return 1;
	if (len < sizeof(place->alias)) {
		memcpy(place->alias, alias, len);
		place->alias[len] = '\0';
		memcpy(place->id, id, sizeof(place->id));
		place->until_ns = bus_now(env) + KEEP_NS;
		listing->next = (listing->next + 1) % LISTING_NAMES;
	}
	return 0;
}

static int listing_put(struct bus_req *req, uint32_t *used, const char *text, size_t len)
{
	if (len > req->len - *used)
		return -EMSGSIZE;
	memcpy(req->data + *used, text, len);
	*used += (uint32_t)len;
	return 0;
}

static int put_entry(struct listing *listing, struct talk *talk, struct bus_req *req,
                     uint32_t *used, const char *entry, size_t len)
{
	struct path path;
	char id[ROM_TEXT_MAX];
	int err = 1;

	if (len == 0 || path_split(entry, len, &path))
		return 0;
	if (path.last.len && !path.has_rom)
		err = find_id(listing, talk, path.last.text, path.last.len, req->deadline_ns, id);
	if (err < 0)
		return err;
	if (err == 0) {
		const char *rest = path.last.text + path.last.len;

		err = listing_put(req, used, entry, (size_t)(path.last.text - entry));
		if (!err)
			err = listing_put(req, used, id, strlen(id));
		if (!err)
			err = listing_put(req, used, rest, (size_t)(entry + len - rest));
	} else {
		err = listing_put(req, used, entry, len);
	}
	return err ? err : listing_put(req, used, "\n", 1);
}

int listing_read(struct listing *listing, struct talk *talk, struct bus_req *req, uint32_t *used)
{
	struct talk_request request = {.type = FRAME_DIRALL,
	                               .fresh = req->fresh,
	                               .path = req->path,
	                               .room = listing->reply,
	                               .limit = sizeof(listing->reply)};
	const char *text = (const char *)listing->reply;
	int err = talk_exchange(talk, &request, req->deadline_ns);
	size_t len, at = 0;

	*used = 0;
	if (err)
		return err;
	if (talk->reader.header.type < 0)
		return 1;
	len = strnlen(text, (size_t)talk->reader.header.payload);
	while (!err && at < len) {
		const char *comma = memchr(text + at, ',', len - at);
		size_t end = comma ? (size_t)(comma - text) : len;

		err = put_entry(listing, talk, req, used, text + at, end - at);
		at = end + 1;
	}
	return err;
}
