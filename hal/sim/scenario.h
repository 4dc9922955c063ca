/* SPDX-License-Identifier: MIT */
/* The scenario language (docs/owsd.sim.5): a text that makes a simulated network. */
#pragma once

#include "hal/sim/net.h"

/*
 * Make a network of the file. 0; -errno of reading it; -EINVAL. why gets the error as
 * "file:line:column: text". net is initialised here, and cleared again after an error.
 */
int sim_scenario_read(const char *file, struct sim_net *net, char *why, size_t why_size);
/* Make a network of a text; name stands for the file in messages. */
int sim_scenario_parse(const char *name, const char *text, struct sim_net *net, char *why,
                       size_t why_size);
