/* SPDX-License-Identifier: MIT */
/* Another configuration, served without a gap. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct config;
struct host;

/* False until the image of the reload before is in place. Supervisor only. */
bool host_may_reload(const struct host *host);
/* A bell (hal/base/bell.h) that rings when a program asks for a reload at the control socket. */
int host_asked_bell(const struct host *host);
/* Does a program wait for a reload? Silences the bell. Supervisor only. */
bool host_asked(struct host *host);
/*
 * Around a reload, for the programs that ask for one before it begins: host_answer() reports them
 * what came of it: 0, and warnings in why ("": none), or a negative errno with the reason in why.
 * Supervisor only.
 */
void host_take_askers(struct host *host);
void host_answer(struct host *host, int err, const char *why);
/*
 * A configuration was refused: consumers see why until one is taken over or owsd ends. Supervisor
 * only.
 */
void host_refused(struct host *host, const char *why);
/*
 * Serve another configuration without a gap: signals of the same name, path and type go on with
 * value, quality, alarms and retries, targets with the same options stay open. Blocks until the
 * reload is done. Returns 0 (the host owns config), or a negative errno with the reason in why:
 * then nothing changes. Only when host_may_reload().
 */
int host_reload(struct host *host, struct config *config, char *why, size_t why_size);
