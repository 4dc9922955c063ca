/* SPDX-License-Identifier: MIT */
/* Another configuration, served without a gap. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct config;
struct control;
struct host;

/* False until the image of the reload before is in place. Supervisor only. */
bool host_may_reload(const struct host *host);
/* Where programs ask for a reload, and are answered. Supervisor only. */
struct control *host_control(const struct host *host);
/*
 * A configuration was refused: consumers see why until one is taken over or owsd ends; err is what
 * host_reload() returned. Supervisor only.
 */
void host_refused(struct host *host, int err, const char *why);
/*
 * Serve another configuration without a gap: signals that stay (adoption.h) go on with value,
 * quality, alarms and retries, targets with the same options stay open. Blocks until the reload is
 * done. Returns 0 (the host owns config), or a negative errno with the reason in why: then nothing
 * changes. -ERESTART: a restart would take it. Only when host_may_reload().
 */
int host_reload(struct host *host, struct config *config, char *why, size_t why_size);

/*
 * The work that must not be done on the engine's thread: look whether the image is still there, and
 * finish what a reload could not do. The supervisor calls it at least twice a second.
 */
void host_tend(struct host *host);
