/* SPDX-License-Identifier: MIT */
/* OWFS's example of a slave: none of its properties needs the wire. */
#include <errno.h>

#include "hal/chips/family.h"

#define EXAMPLE 42

static int read_example(struct txn *txn)
{
	txn->number[0] = EXAMPLE;
	txn->bits = EXAMPLE;
	return 0;
}

static int read_prime(struct txn *txn)
{
	int n = txn->element;

	if (n < 1)
		return -EINVAL;
	txn->number[0] = n > 1;
	for (int i = 2; i * i <= n; i++)
		if (n % i == 0)
			txn->number[0] = 0;
	return 0;
}

enum { WAY_EXAMPLE = 1, WAY_PRIME, WAY_CHARACTERS };
static const struct property_how how[] = {
	[WAY_EXAMPLE] = {.read = read_example},
	[WAY_PRIME] = {.read = read_prime},
	/* the bus has no words behind a dot */
	[WAY_CHARACTERS] = {.read = property_refuse},
};

static const struct property properties[] = {
	PROPERTY("bits", BITS, STABLE, READ, AGGREGATE(8, NUMBERS), .offline = true,
                 .how = WAY_EXAMPLE),
	PROPERTY("extension_characters", UNSIGNED, VOLATILE, READ, SPARSE(LETTERS), .offline = true,
                 .how = WAY_CHARACTERS),
	PROPERTY("is_index_prime", YESNO, VOLATILE, READ, SPARSE(NUMBERS), .offline = true,
                 .how = WAY_PRIME),
	PROPERTY("read_number", INTEGER, STABLE, READ, .offline = true, .how = WAY_EXAMPLE),
};

CHIP_FAMILY(dd, "Example_slave", PRESENCE, .flags = FLAG_ALARM, HOW(how), PROPERTIES(properties));
