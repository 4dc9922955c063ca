/* SPDX-License-Identifier: MIT */
/* An adapter with one wire: its transactions in pieces, its errors, its rivals. */
#include <stdio.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/wire/adapter.h"

#define LOOK_NS (5 * NS_PER_S)

void adapter_init(struct adapter *adapter, const struct adapter_kind *kind,
                  const struct link_master_ops *ops, const struct bus_env *env)
{
	adapter->master = (struct link_master){.ops = ops, .env = env};
	adapter->link = (struct link){.ops = kind->link, .facts = &kind->facts, .env = env};
	adapter->kind = kind;
}

/* What a call of the kind returned. */
static int judge(struct adapter *adapter, int result)
{
	adapter->lost |= result < 0 && result != -ECOMM && result != -EHOSTDOWN &&
	                 result != -EBADMSG;
	return result;
}

/* Before each call on the wire. anew: it begins with a reset, else what went before is needed. */
static int ready(struct adapter *adapter, bool anew)
{
	if (!adapter->open)
		return -ENODEV;
	if (!adapter->lost)
		return 0;
	if (!anew)
		return -EIO;
	int err = adapter->kind->settle(adapter);

	adapter->lost = err != 0;
	return err;
}

int adapter_wait(struct adapter *adapter, int64_t ns)
{
	const struct bus_env *env = adapter->link.env;

	return env->wait(env->ctx, -1, 0, bus_now(env) + ns) < 0 ? -ECANCELED : 0;
}

static bool is_refused(const struct adapter *adapter, enum link_after after)
{
	return after == LINK_STRONG && !adapter->kind->facts.strong;
}

static size_t least(size_t a, size_t b)
{
	return a < b ? a : b;
}

/* The byte after which the wire is fed goes alone: nothing can follow it in a piece. */
int adapter_run(struct link *base, const struct link_part *part)
{
	struct adapter *adapter = adapter_of(base);
	const struct adapter_kind *kind = adapter->kind;
	bool reset = part->reset, strong = part->after == LINK_STRONG && part->out_n;
	size_t out_n = part->out_n - strong, in_n = strong ? 0 : part->in_n;
	size_t out_at = 0, in_at = 0;
	int err = is_refused(adapter, part->after) ? -EOPNOTSUPP : ready(adapter, reset);

	while (!err && (reset || out_at < out_n || in_at < in_n)) {
		size_t out = least(out_n - out_at, kind->piece);
		size_t in = least(in_n - in_at, kind->piece - out);

		err = judge(adapter, kind->pass(adapter, reset, part->out + out_at, out,
		                                part->in + in_at, in));
		reset = false;
		out_at += out;
		in_at += in;
	}
	if (err || !strong)
		return err;
	int back = kind->bits(adapter, part->out[out_n], 8, true);

	return judge(adapter, back < 0 ? back : back == part->out[out_n] ? 0 : -EIO);
}

int adapter_slot(struct link *base, bool out, enum link_after after)
{
	struct adapter *adapter = adapter_of(base);
	int err = is_refused(adapter, after) ? -EOPNOTSUPP : ready(adapter, false);

	return err ? err
	           : judge(adapter, adapter->kind->bits(adapter, out, 1, after == LINK_STRONG));
}

int adapter_path(struct link *base, bool reset, uint8_t command, uint8_t rom[8],
                 uint8_t conflict[8])
{
	struct adapter *adapter = adapter_of(base);
	int err = ready(adapter, reset);

	return err ? err
	           : judge(adapter, adapter->kind->path(adapter, reset, command, rom, conflict));
}

/* The supply of the wire is that of the adapter, which cannot be switched. */
int adapter_recover(struct link *base, enum link_rung rung)
{
	struct adapter *adapter = adapter_of(base);
	const struct link_part reset = {.reset = true};
	int err = 0;

	if (!adapter->open)
		return -ENODEV;
	if (rung == LINK_POWER_CYCLE || (rung == LINK_CHIP_RESET && !adapter->kind->renew))
		return -EOPNOTSUPP;
	if (rung == LINK_CHIP_RESET)
		err = adapter->kind->renew(adapter);
	adapter->lost = err || rung == LINK_BUS_RESET;
	if (!err)
		err = adapter_run(base, &reset);
	return err == -EHOSTDOWN ? 0 : err;
}

void adapter_link_cost(const struct link *link, struct link_cost *cost)
{
	*cost = ((const struct adapter *)((const char *)link - offsetof(struct adapter, link)))
	                ->cost;
}

/* A look goes through the descriptors of all processes: some thousand calls. */
static void look(struct adapter *adapter, bool failed)
{
	int64_t now_ns = bus_now(adapter->master.env);

	if (!adapter->proc || (failed && now_ns < adapter->look_ns))
		return;
	adapter->look_ns = now_ns + LOOK_NS;
	(void)rivals_find(adapter->proc, adapter->device, adapter->rivals, sizeof(adapter->rivals));
}

void adapter_accuse(struct adapter *adapter, char *why, size_t size)
{
	char who[RIVALS_TEXT] = "", text[RIVALS_TEXT + 40] = "";
	size_t len;

	look(adapter, true);
	if (*adapter->rivals)
		snprintf(text, sizeof(text), "also open in %s: ", adapter->rivals);
	else if (adapter->proc && rivals_hidden(adapter->proc, who, sizeof(who)))
		snprintf(text, sizeof(text), "%s runs, and may have it open: ", who);
	len = strlen(text);
	if (!len || len + strlen(why) >= size)
		return;
	memmove(why + len, why, strlen(why) + 1);
	memcpy(why, text, len);
}

void adapter_trouble(struct link_master *base, bool failed, char *text, size_t size)
{
	struct adapter *adapter = (struct adapter *)base;

	look(adapter, failed);
	text[0] = '\0';
	if (*adapter->rivals)
		snprintf(text, size,
		         "%s is also open in %s: two programs on one adapter disturb each other",
		         adapter->name, adapter->rivals);
}

unsigned adapter_channels(struct link_master *base)
{
	return ((struct adapter *)base)->open;
}

struct link *adapter_channel(struct link_master *base, unsigned n)
{
	return n == 0 ? &((struct adapter *)base)->link : NULL;
}

void adapter_cost(const struct link_master *base, struct link_master_cost *cost)
{
	*cost = ((const struct adapter *)base)->shared;
}
