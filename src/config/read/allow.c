/* SPDX-License-Identifier: MIT */
/* The key ControlAllow of the driver block: which users may command which signals. */
#include <fnmatch.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/read/allow.h"
#include "src/config/read/build.h"
#include "src/config/read/options.h"
#include "src/memory/shm/owner.h"
#include "src/memory/shm/peer.h"

#define BLANK " \t"
#define HOLDER_MAX 63 /* the longest name of a user or a group */

static bool find_id(const char *name, bool group, uint32_t *id)
{
	unsigned long number;
	uid_t uid;
	gid_t gid;
	char *end;

	if (group && owner_group(name, &gid)) {
		*id = gid;
		return true;
	}
	if (!group && owner_user(name, &uid)) {
		*id = uid;
		return true;
	}
	number = strtoul(name, &end, 10);
	*id = (uint32_t)number;
	/* the last number is no user: chown() takes it for "as before" */
	return *name >= '0' && *name <= '9' && !*end && number < UINT32_MAX;
}

/* Adds user:NAME or group:NAME; one that this machine does not know has no rights. */
static void add_holder(struct build *build, struct config_allow *allow, const char *word,
                       size_t len, struct rio_position position)
{
	char name[HOLDER_MAX + 1] = "";
	bool user = !strncmp(word, "user:", 5), group = !strncmp(word, "group:", 6);
	size_t prefix = user ? 5 : 6;
	uint32_t id;

	if ((!user && !group) || len <= prefix || len - prefix > HOLDER_MAX) {
		report_error(build->report, position,
		             "ControlAllow \"%.*s\": expected user:NAME or group:NAME", (int)len,
		             word);
		return;
	}
	memcpy(name, word + prefix, len - prefix);
	if (find_id(name, group, &id))
		allow->holders[allow->holder_count++] = (struct config_holder){.group = group,
		                                                               .id = id};
	else
		report_warning(build->report, position, "ControlAllow: there is no %s %s here",
		               group ? "group" : "user", name);
}

/* A slip in the pattern would leave its signals to the group owsd-control. */
static bool fits_some(const struct config *config, const char *pattern)
{
	for (unsigned i = 0; i < config->item_count; i++)
		if (fnmatch(pattern, config->items[i].name, 0) == 0)
			return true;
	return config->item_count == 0;
}

static void add_allow(struct build *build, const struct rio_node *node)
{
	struct config *config = &build->box->config;
	struct config_allow *allow = &config->allows[config->allow_count];
	const char *text = node->value + strspn(node->value, BLANK);
	size_t len = strcspn(text, BLANK);

	if (!text[len + strspn(text + len, BLANK)]) {
		report_error(build->report, node->value_at,
		             "ControlAllow \"%s\": expected a pattern of signal names, then "
		             "user:NAME or group:NAME",
		             node->value);
		return;
	}
	allow->text = build_keep(build, node->value, strlen(node->value));
	allow->pattern = build_keep(build, text, len);
	/* a word and its blank are two bytes at least */
	allow->holders = build_take(build, strlen(text) / 2, sizeof(*allow->holders));
	if (build->no_memory)
		return;
	for (text += len; *(text += strspn(text, BLANK)); text += len) {
		len = strcspn(text, BLANK);
		add_holder(build, allow, text, len, node->value_at);
	}
	if (!fits_some(config, allow->pattern))
		report_warning(build->report, node->value_at,
		               "ControlAllow: no signal fits the pattern %s", allow->pattern);
	config->allow_count++;
}

static bool is_allow(const struct rio_node *node)
{
	return (node->kind == RIO_STRING || node->kind == RIO_WORD) && !node->broken &&
	       !strcmp(node->key, option_table[OPT_CONTROL_ALLOW].key);
}

void allow_build(struct build *build, const struct rio_node *driver)
{
	unsigned count = 0;

	for (const struct rio_node *node = driver->first; node; node = node->next)
		count += is_allow(node);
	build->box->config.allows = build_take(build, count, sizeof(*build->box->config.allows));
	if (build->no_memory)
		return;
	for (const struct rio_node *node = driver->first; node; node = node->next)
		if (is_allow(node))
			add_allow(build, node);
}

bool allow_names(const struct config_allow *allow, const struct peer *peer)
{
	for (unsigned i = 0; i < allow->holder_count; i++) {
		const struct config_holder *holder = &allow->holders[i];

		if (holder->group ? peer_in_group(peer, holder->id) : peer->uid == holder->id)
			return true;
	}
	return false;
}

enum allow_word allow_ask(const struct config *config, const struct peer *peer, const char *name)
{
	enum allow_word word = ALLOW_OPEN;

	for (unsigned i = 0; i < config->allow_count; i++) {
		if (fnmatch(config->allows[i].pattern, name, 0) != 0)
			continue;
		if (peer && allow_names(&config->allows[i], peer))
			return ALLOW_YES;
		word = ALLOW_NO;
	}
	return word;
}
