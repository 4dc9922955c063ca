/* SPDX-License-Identifier: MIT */
/* Targets that lead back to the owsd that has them. */
#include <errno.h>
#include <string.h>

#include "src/config/check/own.h"
#include "src/config/check/targets.h"

#define SCHEME "owserver:"

static bool is_any(const struct listen_address *address)
{
	static const uint8_t any[16];

	return memcmp(address->bytes, any, sizeof(any)) == 0;
}

/*
 * Does target reach the server at served? A server at all addresses is reached at any of this
 * machine.
 */
static bool reaches(const struct listen_address *served, const struct listen_address *target)
{
	if (!served->port || served->port != target->port)
		return false;
	if (is_any(served))
		return listen_is_loopback(target) && (served->is_v6 || !target->is_v6);
	return listen_same(served, target);
}

static bool is_own(const struct config_serve *serve, const char *target)
{
	struct listen_address address[2];
	char canonical[TARGET_CANONICAL];
	const char *host, *why;
	int n;

	target_canonical(target, canonical);
	if (strncmp(canonical, SCHEME, strlen(SCHEME)) != 0)
		return false;
	host = canonical + strlen(SCHEME);
	if (*host == '/')
		return serve->socket && strcmp(serve->socket, host) == 0;
	n = listen_parse(host, strlen(host), address, &why);
	for (int i = 0; i < n; i++)
		for (unsigned k = 0; k < serve->address_count; k++)
			if (reaches(&serve->addresses[k], &address[i]))
				return true;
	return false;
}

bool config_has_servers(const struct config *config)
{
	char canonical[TARGET_CANONICAL];

	for (unsigned i = 0; i < config->target_count; i++) {
		target_canonical(config->targets[i].text, canonical);
		if (strncmp(canonical, SCHEME, strlen(SCHEME)) == 0)
			return true;
	}
	return false;
}

/* Remove target i; the next way takes its relation to the target before. */
static void remove_target(struct config *config, unsigned i)
{
	struct config_target *target = &config->targets[i];

	if (i + 1 < config->target_count && target[1].relation == CONFIG_BAR)
		target[1].relation = target->relation;
	config->target_count--;
	memmove(target, target + 1, (config->target_count - i) * sizeof(*target));
}

int config_check_own(struct config *config, struct config_report *report)
{
	unsigned before = report->errors;

	for (unsigned i = 0; i < config->target_count; i++) {
		const struct config_target *target = &config->targets[i];
		struct rio_position position = target_position(config, target);

		if (!is_own(&config->serve, target->text))
			continue;
		if (!target->automatic) {
			report_error(report, position,
			             "the target \"%s\" is where this owsd listens", target->text);
			continue;
		}
		report_warning(report, position,
		               "auto looks for no owserver at %s: this owsd listens "
		               "there",
		               target->text);
		remove_target(config, i--);
	}
	return report->errors == before ? 0 : -EINVAL;
}
