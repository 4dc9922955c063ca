#!/bin/sh
# SPDX-License-Identifier: MIT
# The makefile takes the libgpiod that the compiler sees, whatever a pkg-config says of this machine's;
# and the file for libgpiod 2 compiles, though this machine may have the other one.
set -eu

unset MAKEFLAGS MFLAGS MAKELEVEL MAKEOVERRIDES CFLAGS LDFLAGS EXTRA_CFLAGS CROSS_COMPILE LIBGPIOD
mkdir both lib1 lib2 none
printf '#!/bin/sh\ncase "$*" in *--libs*) echo -lgpiod ;; esac\n' >says-2
printf '#!/bin/sh\ncase "$*" in *--atleast-version*) exit 1 ;; *--libs*) echo -lgpiod ;; esac\n' >says-1
printf '#!/bin/sh\nexit 127\n' >says-nothing
chmod +x says-*
echo 'struct gpiod_chip; void gpiod_chip_close(struct gpiod_chip *chip);' >both/both.h
printf '#include "../both/both.h"\nconst char *gpiod_chip_name(struct gpiod_chip *chip);\n' >lib1/gpiod.h
printf '#include "../both/both.h"\nvoid *gpiod_chip_get_info(struct gpiod_chip *chip);\n' >lib2/gpiod.h
echo '#error none here' >none/gpiod.h
echo 'void gpiod_chip_close(void) {} void gpiod_chip_name(void) {}' >lib1/all.c
echo 'void gpiod_chip_close(void) {} void gpiod_chip_get_info(void) {}' >lib2/all.c
for n in 1 2; do
	gcc -shared -fPIC -nostdlib -o lib$n/libgpiod.so lib$n/all.c
done

# taken DIR PKG_CONFIG: 1, 2 or nothing
taken() {
	make -s -n -p -C "$OWSD_SOURCE" --no-print-directory B="$PWD/out" LIBI2C=0 PKG_CONFIG="$PWD/$2" \
		CC="gcc -I$PWD/$1 -L$PWD/$1" clean 2>/dev/null | sed -n 's/^LIBGPIOD := *//p'
}
for n in 1 2; do
	for says in says-1 says-2 says-nothing; do
		got=$(taken lib$n $says)
		[ "$got" = $n ] || { echo "lib$n with a pkg-config that $says: '$got'" && exit 1; }
	done
done
got=$(taken none says-2)
[ -z "$got" ] || { echo "without a header: '$got'" && exit 1; }

# What owsd uses of libgpiod 2.2, by its documentation.
mkdir two
cat >two/gpiod.h <<'END'
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
struct gpiod_chip;
struct gpiod_chip_info;
struct gpiod_line_info;
struct gpiod_line_settings;
struct gpiod_line_config;
struct gpiod_request_config;
struct gpiod_line_request;
struct gpiod_edge_event;
struct gpiod_edge_event_buffer;
enum gpiod_line_value {
	GPIOD_LINE_VALUE_ERROR = -1,
	GPIOD_LINE_VALUE_INACTIVE = 0,
	GPIOD_LINE_VALUE_ACTIVE = 1,
};
enum gpiod_line_direction {
	GPIOD_LINE_DIRECTION_AS_IS = 1,
	GPIOD_LINE_DIRECTION_INPUT,
	GPIOD_LINE_DIRECTION_OUTPUT,
};
enum gpiod_line_edge { GPIOD_LINE_EDGE_NONE = 1, GPIOD_LINE_EDGE_BOTH = 4 };
enum gpiod_line_bias {
	GPIOD_LINE_BIAS_AS_IS = 1,
	GPIOD_LINE_BIAS_PULL_UP = 4,
	GPIOD_LINE_BIAS_PULL_DOWN,
};
enum gpiod_line_drive {
	GPIOD_LINE_DRIVE_PUSH_PULL = 1,
	GPIOD_LINE_DRIVE_OPEN_DRAIN,
	GPIOD_LINE_DRIVE_OPEN_SOURCE,
};
enum gpiod_edge_event_type { GPIOD_EDGE_EVENT_RISING_EDGE = 1, GPIOD_EDGE_EVENT_FALLING_EDGE };
const char *gpiod_api_version(void);
struct gpiod_chip *gpiod_chip_open(const char *path);
void gpiod_chip_close(struct gpiod_chip *chip);
struct gpiod_chip_info *gpiod_chip_get_info(struct gpiod_chip *chip);
struct gpiod_line_info *gpiod_chip_get_line_info(struct gpiod_chip *chip, unsigned int offset);
struct gpiod_line_request *gpiod_chip_request_lines(struct gpiod_chip *chip,
	struct gpiod_request_config *req_cfg, struct gpiod_line_config *line_cfg);
void gpiod_chip_info_free(struct gpiod_chip_info *info);
const char *gpiod_chip_info_get_label(struct gpiod_chip_info *info);
size_t gpiod_chip_info_get_num_lines(struct gpiod_chip_info *info);
void gpiod_line_info_free(struct gpiod_line_info *info);
const char *gpiod_line_info_get_name(struct gpiod_line_info *info);
const char *gpiod_line_info_get_consumer(struct gpiod_line_info *info);
bool gpiod_line_info_is_used(struct gpiod_line_info *info);
enum gpiod_line_direction gpiod_line_info_get_direction(struct gpiod_line_info *info);
struct gpiod_line_settings *gpiod_line_settings_new(void);
void gpiod_line_settings_free(struct gpiod_line_settings *settings);
int gpiod_line_settings_set_direction(struct gpiod_line_settings *settings,
	enum gpiod_line_direction direction);
int gpiod_line_settings_set_edge_detection(struct gpiod_line_settings *settings,
	enum gpiod_line_edge edge);
int gpiod_line_settings_set_bias(struct gpiod_line_settings *settings, enum gpiod_line_bias bias);
int gpiod_line_settings_set_drive(struct gpiod_line_settings *settings, enum gpiod_line_drive drive);
void gpiod_line_settings_set_active_low(struct gpiod_line_settings *settings, bool active_low);
int gpiod_line_settings_set_output_value(struct gpiod_line_settings *settings,
	enum gpiod_line_value value);
struct gpiod_line_config *gpiod_line_config_new(void);
void gpiod_line_config_free(struct gpiod_line_config *config);
int gpiod_line_config_add_line_settings(struct gpiod_line_config *config,
	const unsigned int *offsets, size_t num_offsets, struct gpiod_line_settings *settings);
struct gpiod_request_config *gpiod_request_config_new(void);
void gpiod_request_config_free(struct gpiod_request_config *config);
void gpiod_request_config_set_consumer(struct gpiod_request_config *config, const char *consumer);
void gpiod_request_config_set_event_buffer_size(struct gpiod_request_config *config, size_t size);
void gpiod_line_request_release(struct gpiod_line_request *request);
enum gpiod_line_value gpiod_line_request_get_value(struct gpiod_line_request *request,
	unsigned int offset);
int gpiod_line_request_set_value(struct gpiod_line_request *request, unsigned int offset,
	enum gpiod_line_value value);
int gpiod_line_request_get_fd(struct gpiod_line_request *request);
int gpiod_line_request_wait_edge_events(struct gpiod_line_request *request, int64_t timeout_ns);
int gpiod_line_request_read_edge_events(struct gpiod_line_request *request,
	struct gpiod_edge_event_buffer *buffer, size_t max_events);
struct gpiod_edge_event_buffer *gpiod_edge_event_buffer_new(size_t capacity);
void gpiod_edge_event_buffer_free(struct gpiod_edge_event_buffer *buffer);
struct gpiod_edge_event *gpiod_edge_event_buffer_get_event(struct gpiod_edge_event_buffer *buffer,
	unsigned long index);
uint64_t gpiod_edge_event_get_timestamp_ns(struct gpiod_edge_event *event);
enum gpiod_edge_event_type gpiod_edge_event_get_event_type(struct gpiod_edge_event *event);
END
gcc -std=c17 -D_GNU_SOURCE -Wall -Wextra -Werror -fsyntax-only -DOWSD_LIBGPIOD=2 -Itwo -I"$OWSD_SOURCE" \
	"$OWSD_SOURCE/hal/gpio/library_v2.c"
