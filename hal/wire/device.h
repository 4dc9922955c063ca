/* SPDX-License-Identifier: MIT */
/*
 * The device table of a native bus: every id that was ever seen, its channel, and what is known of
 * the chip. Bounded; a device keeps its place while it is away, so that it is known again.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define DEVICE_MAX 512
#define DEVICE_ALIAS_MAX 256

enum device_power {
	POWER_UNKNOWN,
	POWER_ASSUMED, /* it could not be asked, and counts as parasitic */
	POWER_PARASITE,
	POWER_EXTERNAL,
};

static inline bool device_power_known(uint8_t power)
{
	return power != POWER_UNKNOWN && power != POWER_ASSUMED;
}

static inline bool device_is_fed(uint8_t power)
{
	return power == POWER_PARASITE || power == POWER_ASSUMED;
}

struct family;

/* What was read of a chip: txn_share(). */
#define DEVICE_READINGS 6
struct device_reading {
	const void *what; /* NULL: free */
	uint16_t at, n;
	int64_t begun_ns, made_ns;
	uint8_t bytes[32];
};
#define DEVICE_OWN 96

struct device {
	const struct family *family;
	uint8_t rom[8];
	uint8_t channel;
	uint8_t before;   /* the channel on which it answered until it did on this one */
	uint8_t returns;  /* so often in a row it was soon back on that */
	int64_t moved_ns; /* when it answered on another channel */
	bool present;
	bool astray;      /* did not answer where it was: the search for all wires will tell */
	bool likely;      /* found by the first bits of its id, and has not answered since */
	bool settled;     /* was read or written since it came or restarted */
	bool locked;      /* a job of several transactions is at work with it */
	bool named;       /* requests name it: nothing else takes its place */
	uint8_t failures; /* requests in a row that it failed */
	uint8_t missed;   /* searches in a row that did not see it */
	uint8_t cut;      /* so many bits of it the last background search read; 0: all */
	uint32_t seen;    /* number of the last background search that saw it */
	uint32_t changes; /* grows when what is cached of it is void */
	int64_t ok_ns;    /* last transaction that proved its presence; 0: never */
	int64_t told_ns;  /* when family.identify told its kind; 0: never */
	uint8_t kind;     /* of a family.several: which of its chips it is; 0: not known */

	uint8_t power;        /* enum device_power */
	const char *identity; /* what readings have shown that it is; NULL: nothing so far */

	/* An LCD's pins: the byte that was last written and verified. */
	uint8_t shadow;
	bool shadow_known;

	/*
	 * What stood in registers before a change that has not succeeded yet, and which bits of it
	 * were to change: unfinished.h.
	 */
	uint8_t base[32], asked[32];
	uint16_t base_at;
	const void *base_of; /* which registers; NULL: none */

	struct device_reading readings[DEVICE_READINGS];
	uint32_t readings_of; /* `changes` when they were made */

	void *own; /* DEVICE_OWN bytes for a struct of the family; zero when nothing is known */
	struct device_table *table; /* where it stands */
};

struct device_table {
	struct device *devices; /* DEVICE_MAX */
	unsigned char (*own)[DEVICE_OWN];
	char (*aliases)[DEVICE_ALIAS_MAX + 1];
	unsigned count;
};

int device_table_create(struct device_table *table);
void device_table_destroy(struct device_table *table);
/* By the first seven bytes of its id; NULL: it is not in the table. */
struct device *device_find(struct device_table *table, const uint8_t rom[8]);
/*
 * The device's place, a new one if need be: of a full table that of a device that is away, has no
 * alias and is not asked for. NULL: no place.
 */
struct device *device_add(struct device_table *table, const uint8_t rom[8],
                          const struct family *family, unsigned channel);
/* What every family knows of the chip's state is void: family_forget() does the rest. */
void device_forget(struct device *device);
/* "": it has none. */
const char *device_alias(const struct device *device);
/* Another device of that alias loses it. -EINVAL: such a text is no alias. */
int device_set_alias(struct device *device, const char *text, size_t len);
struct device *device_by_alias(struct device_table *table, const char *name, size_t len);
