/* SPDX-License-Identifier: MIT */
/* Who may command which signal: ControlAllow of the configuration, and the rule without it. */
#include <unistd.h>

#include "src/config/read/allow.h"
#include "src/config/read/config.h"
#include "src/memory/control/rights.h"
#include "src/memory/shm/owner.h"

void rights_find(struct rights *r, const struct config *config)
{
	bool service = geteuid() == 0 || owner_is_service();

	*r = (struct rights){.config = config, .own = geteuid()};
	r->has_controllers = service && owner_group("owsd-control", &r->controllers);
	r->has_readers = service && owner_group("owsd", &r->readers);
	r->has_configurers = service && owner_group("owsd-config", &r->configurers);
}

static bool has_all(const struct rights *r, const struct peer *peer)
{
	return peer->uid == 0 || peer->uid == r->own;
}

static bool by_default(const struct rights *r, const struct peer *peer)
{
	return r->has_controllers && peer_in_group(peer, r->controllers);
}

bool rights_set(const struct rights *r, const struct peer *peer, const char *name)
{
	enum allow_word word;

	if (has_all(r, peer))
		return true;
	word = allow_ask(r->config, peer, name);
	return word == ALLOW_YES || (word == ALLOW_OPEN && by_default(r, peer));
}

bool rights_set_any(const struct rights *r, const struct peer *peer)
{
	if (has_all(r, peer) || by_default(r, peer))
		return true;
	for (unsigned i = 0; i < r->config->allow_count; i++)
		if (allow_names(&r->config->allows[i], peer))
			return true;
	return false;
}

bool rights_read(const struct rights *r, const struct peer *peer)
{
	return has_all(r, peer) || (r->has_readers && peer_in_group(peer, r->readers));
}

bool rights_reload(const struct rights *r, const struct peer *peer)
{
	return has_all(r, peer) || (r->has_configurers && peer_in_group(peer, r->configurers));
}

uint32_t rights_fill(const struct rights *r, const struct peer *peer, uint32_t *bits)
{
	uint32_t count = 0;

	if (rights_set(r, peer, ""))
		bits[0] |= 1;
	for (uint32_t i = 0; i < r->config->item_count; i++) {
		if (!rights_set(r, peer, r->config->items[i].name))
			continue;
		bits[(i + 1) / 32] |= 1u << (i + 1) % 32;
		count++;
	}
	return count;
}
