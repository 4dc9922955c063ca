/* SPDX-License-Identifier: MIT */
/* The keys Listen... of the driver block. */
#ifndef CONFIG_SERVE_H
#define CONFIG_SERVE_H

struct build;
struct option_value;

/* Where the owserver protocol is served, and to whom. */
void serve_build(struct build *build, const struct option_value *values);
/* The addresses of owsd -l in their place. 0 or -EINVAL. */
int serve_listens(struct build *build, const char *const *texts, unsigned count);

#endif
