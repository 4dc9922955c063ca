/* SPDX-License-Identifier: MIT */
/* What a configuration names, held against what is known of the chips. */
#pragma once

struct config;
struct config_report;

/*
 * Check a whole configuration that was parsed: what owsd --check, the writer and the page report
 * alike, but for what only the backends know (target_check_config() of src/daemon/host). Targets
 * that are given twice or lead back to this owsd; warnings of Bus blocks and of items. 0 or
 * -EINVAL.
 */
int config_check(struct config *config, struct config_report *report);

/*
 * Fill in what a family decides, as config_know(), and warn of what can hardly be meant: ids that
 * cannot exist, the kernel's spelling of ids, properties that the family has not, commands to what
 * cannot be written, texts for numbers, keys that do nothing. Each warning has the remedy. Another
 * server may know more than owsd, so nothing of it is an error. name NULL: of all items; a name
 * that no item has is no fault.
 */
void config_check_items(struct config *config, const char *name, struct config_report *report);
