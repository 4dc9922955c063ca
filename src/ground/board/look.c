/* SPDX-License-Identifier: MIT */
/*
 * Finds what the files of /proc and /sys, and the data of boards, show about this machine. Each
 * path begins with the folder `root`, so that a test can show it another machine.
 */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <grp.h>
#include <pwd.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/rivals.h"
#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/look.h"
#include "hal/serial/find.h"
#include "hal/usb/find.h"
#include "src/ground/board/data.h"
#include "src/ground/board/files.h"
#include "src/ground/board/look.h"
#include "src/ground/board/report.h"

#define BOARDS 48
#define ADAPTERS 64

struct scene {
	const char *root;
	struct board_report *report;
	const struct board_data *board; /* NULL: no board that is known */
	const struct board_data *hat;
};

void board_folder(char *folder, size_t size)
{
	static const char *const beside[] = {"../share/owsd/boards", "../board/boards"};
	const char *given = getenv("OWSD_BOARDS");
	char exe[256], *slash;
	ssize_t n;

	if (given && *given) {
		snprintf(folder, size, "%s", given);
		return;
	}
	n = readlink("/proc/self/exe", exe, sizeof(exe) - 1);
	exe[n > 0 ? n : 0] = '\0';
	slash = strrchr(exe, '/');
	if (slash)
		*slash = '\0';
	for (size_t i = 0; i < sizeof(beside) / sizeof(beside[0]); i++) {
		snprintf(folder, size, "%s/%s", slash ? exe : "/usr/bin", beside[i]);
		if (access(folder, X_OK) == 0)
			return;
	}
	snprintf(folder, size, "%s/%s", slash ? exe : "/usr/bin", beside[0]);
}

static void name_board(const struct scene *scene, const char *model)
{
	if (scene->board)
		report_add(scene->report, BOARD_FACT, "board: %s (%s)",
		           model[0] ? model : scene->board->name, scene->board->id);
	else if (model[0])
		report_add(scene->report, BOARD_FACT, "board: %s, of which there is no data",
		           model);
	else
		report_add(scene->report, BOARD_FACT,
		           "board: it does not say which (no "
		           "/proc/device-tree/model)");
}

static void name_hat(const struct scene *scene, const char *vendor, const char *product)
{
	const struct board_data *hat = scene->hat;

	if (hat)
		report_add(scene->report, BOARD_FACT, "on it: %s (%s)%s%s", hat->name, hat->id,
		           hat->chip[0] ? ", " : "", hat->chip);
	else if (product[0])
		report_add(scene->report, BOARD_FACT, "on it: %s of %s, of which there is no data",
		           product, vendor[0] ? vendor : "unknown vendor");
}

static void report_notes(const struct scene *scene, const struct board_data *data)
{
	for (unsigned i = 0; data && i < BOARD_NOTES && data->note[i][0]; i++)
		report_add(scene->report, BOARD_NOTE, "%s", data->note[i]);
}

static void report_adapter(const struct scene *scene, unsigned number)
{
	char file[80];
	unsigned hz;

	snprintf(file, sizeof(file), "/sys/bus/i2c/devices/i2c-%u/of_node/clock-frequency", number);
	hz = board_cell(scene->root, file);
	if (hz)
		report_add(scene->report, BOARD_FACT, "I2C: /dev/i2c-%u at %u kHz", number,
		           hz / 1000);
	else
		report_add(scene->report, BOARD_FACT, "I2C: /dev/i2c-%u", number);
	if (!scene->board || !hz || hz / 1000 >= scene->board->khz)
		return;
	report_add(scene->report, BOARD_NOTE,
	           "I2C runs at %u kHz; a DS2482 takes %u, and its "
	           "answers come sooner",
	           hz / 1000, scene->board->khz);
	if (scene->board->speed_line[0])
		report_command(scene->report, "echo %s | sudo tee -a %s && sudo reboot",
		               scene->board->speed_line, board_config(scene->root));
}

static void miss_interface(const struct scene *scene, unsigned number)
{
	const struct board_data *board = scene->board;
	const char *config = board_config(scene->root);

	if (board->on_line[0] && board_configured(scene->root, board->on_line)) {
		report_add(scene->report, BOARD_MISSING,
		           "there is no I2C adapter i2c-%u, though %s has %s: was it started "
		           "since?",
		           number, config, board->on_line);
		report_remedy(scene->report, "sudo reboot");
		return;
	}
	report_add(scene->report, BOARD_MISSING, "I2C is off: there is no adapter i2c-%u", number);
	if (board->enable[0])
		report_remedy(scene->report, "%s    # or %s in %s, and a reboot", board->enable,
		              board->on_line, config);
}

static void miss_module(const struct scene *scene, const char *which)
{
	report_add(scene->report, BOARD_MISSING, "there is no %s: the module i2c-dev is not loaded",
	           which);
	report_remedy(scene->report,
	              "sudo modprobe i2c-dev    # at each start: echo i2c-dev | sudo tee "
	              "/etc/modules-load.d/i2c-dev.conf");
}

static void miss_permission(const struct scene *scene, const char *device, const struct stat *st)
{
	const struct passwd *user = getpwuid(geteuid());
	const struct group *group = st->st_gid ? getgrgid(st->st_gid) : NULL;

	report_add(scene->report, BOARD_MISSING, "no permission for %s", device);
	if (group && (st->st_mode & 060) == 060)
		report_command(scene->report, "sudo adduser %s %s    # then log in again",
		               user ? user->pw_name : "USER", group->gr_name);
	else
		report_command(scene->report,
		               "sudo chgrp i2c %s && sudo chmod g+rw %s    # the package's "
		               "udev rule does it at each start",
		               device, device);
}

/* May the device file be opened? If not, report it. */
static bool may_use(const struct scene *scene, unsigned number)
{
	char path[BOARD_PATH];
	const char *device = path + strlen(scene->root);
	struct stat st;

	board_path(path, scene->root, I2C_DEV_ROOT "/i2c-%u", number);
	if (faccessat(AT_FDCWD, path, R_OK | W_OK, AT_EACCESS) == 0)
		return true;
	if (stat(path, &st) == 0)
		miss_permission(scene, device, &st);
	else
		miss_module(scene, device);
	return false;
}

static void look_for_claims(const struct scene *scene, unsigned number)
{
	for (unsigned i = 0; i < DS2482_ADDRESSES; i++) {
		unsigned address = DS2482_FIRST_ADDRESS + i;
		char file[80], driver[32];

		snprintf(file, sizeof(file), I2C_SYS_ROOT "/%u-%04x/driver", number, address);
		board_link(scene->root, file, driver, sizeof(driver));
		if (strcmp(driver, "ds2482"))
			continue;
		report_add(scene->report, BOARD_NOTE,
		           "the chip at 0x%02x of i2c-%u is claimed by the "
		           "kernel's driver ds2482: target w1 reaches it, and so does auto; this "
		           "gives it to i2c:/dev/i2c-%u",
		           address, number, number);
		report_remedy(scene->report,
		              "echo %u-%04x | sudo tee /sys/bus/i2c/drivers/ds2482/unbind", number,
		              address);
	}
}

/* Root sees the programs of all users, and the service of owsd does not. */
static void look_for_rivals(const struct scene *scene, unsigned number)
{
	char path[BOARD_PATH], proc[BOARD_PATH], who[RIVALS_TEXT];

	board_path(path, scene->root, I2C_DEV_ROOT "/i2c-%u", number);
	board_path(proc, scene->root, RIVALS_PROC);
	rivals_find(proc, path, who, sizeof(who));
	if (!who[0])
		return;
	report_add(scene->report, BOARD_RIVAL,
	           "i2c-%u is open in %s: two programs on one DS2482 disturb each other", number,
	           who);
	report_remedy(scene->report,
	              "sudo systemctl disable --now owserver.socket owserver.service    # if it is "
	              "that one");
}

static void look_at_header(const struct scene *scene, unsigned number)
{
	char file[48];

	snprintf(file, sizeof(file), I2C_SYS_ROOT "/i2c-%u", number);
	if (!board_there(scene->root, file)) {
		miss_interface(scene, number);
		return;
	}
	report_adapter(scene, number);
	may_use(scene, number);
	look_for_claims(scene, number);
	look_for_rivals(scene, number);
}

/* The serial ports that stay what they are, who has one, and DS9490R. Are there any? */
static bool report_ports(const struct scene *scene)
{
	char pattern[BOARD_PATH], proc[BOARD_PATH], who[RIVALS_TEXT];
	struct usb_place places[USB_PLACES];
	unsigned count;
	bool any;
	glob_t found;

	board_path(proc, scene->root, RIVALS_PROC);
	board_path(pattern, scene->root, SERIAL_BY_ID "/*");
	if (glob(pattern, 0, NULL, &found) == 0)
		for (size_t i = 0; i < found.gl_pathc; i++) {
			rivals_find(proc, found.gl_pathv[i], who, sizeof(who));
			report_add(scene->report, BOARD_FACT, "serial port: %s%s%s",
			           found.gl_pathv[i] + strlen(scene->root),
			           *who ? ", open in " : "", who);
		}
	any = found.gl_pathc;
	globfree(&found);
	board_path(pattern, scene->root, "/sys/bus/usb/devices");
	count = usb_find(pattern, places);
	for (unsigned i = 0; i < count; i++)
		report_add(scene->report, BOARD_FACT, "USB adapter: DS9490R at %s (target usb:)",
		           places[i].device);
	return any || count;
}

/* A machine without board data: any adapter will do; none is missing where another kind is. */
static void look_at_adapters(const struct scene *scene, bool others)
{
	unsigned number[ADAPTERS], count;
	char path[BOARD_PATH];
	struct stat st;
	bool usable = false;

	board_path(path, scene->root, I2C_SYS_ROOT);
	count = i2c_list(path, number, ADAPTERS);
	if (!count && others)
		return;
	if (!count) {
		report_add(scene->report, BOARD_MISSING,
		           "there is no I2C adapter: switch it on in "
		           "the firmware or the device tree, or load its driver");
		return;
	}
	for (unsigned i = 0; i < count; i++) {
		if (i < 8)
			report_adapter(scene, number[i]);
		board_path(path, scene->root, I2C_DEV_ROOT "/i2c-%u", number[i]);
		usable |= faccessat(AT_FDCWD, path, R_OK | W_OK, AT_EACCESS) == 0;
		look_for_claims(scene, number[i]);
		look_for_rivals(scene, number[i]);
	}
	if (usable)
		return;
	for (unsigned i = 0; i < count; i++) {
		board_path(path, scene->root, I2C_DEV_ROOT "/i2c-%u", number[i]);
		if (stat(path, &st))
			continue;
		miss_permission(scene, path + strlen(scene->root), &st);
		return;
	}
	miss_module(scene, I2C_DEV_ROOT "/i2c-*");
}

/* The line may have parameters, as gpiopin=17. */
static void advise_master(const struct scene *scene)
{
	const char *line = scene->board->wire_line, *config = board_config(scene->root);
	bool there = board_configured(scene->root, line);

	snprintf(scene->report->master, sizeof(scene->report->master),
	         there ? "sudo reboot    # %.80s is in %s; if it was started since: dmesg"
	               : "echo %.80s | sudo tee -a %s && sudo reboot",
	         line, config);
}

static void report_masters(const struct scene *scene)
{
	char path[BOARD_PATH], names[160] = "";
	size_t used = 0;
	DIR *dir;

	board_path(path, scene->root, "/sys/bus/w1/devices");
	dir = opendir(path);
	for (struct dirent *entry; dir && (entry = readdir(dir));) {
		size_t len = strlen(entry->d_name);

		if (strncmp(entry->d_name, "w1_bus_master", 13) || used + len + 2 >= sizeof(names))
			continue;
		used += (size_t)snprintf(names + used, sizeof(names) - used, " %s", entry->d_name);
	}
	if (dir)
		closedir(dir);
	if (names[0])
		report_add(scene->report, BOARD_FACT, "the kernel's 1-Wire masters:%s (target w1)",
		           names);
	else if (scene->board && scene->board->wire_line[0])
		advise_master(scene);
}

/* Find the base board and the HAT; the data of a named board decide which of both it is. */
static int look_find(struct scene *scene, const struct board_data *data, unsigned count,
                     const char *id, char *why, size_t why_size)
{
	const struct board_data *named = id ? board_data_id(data, count, id) : NULL;
	size_t used;

	if (named && named->enable[0])
		scene->board = named;
	else if (named)
		scene->hat = named;
	if (!id || named)
		return 0;
	used = (size_t)snprintf(why, why_size, "no board \"%.40s\"; there are", id);
	for (unsigned i = 0; i < count && used < why_size; i++)
		used += (size_t)snprintf(why + used, why_size - used, " %s", data[i].id);
	return -ENOENT;
}

int board_look(const char *root, const char *folder, const char *id, struct board_report *report,
               char *why, size_t why_size)
{
	struct board_data *data = calloc(BOARDS, sizeof(*data));
	struct scene scene = {.root = root, .report = report};
	char model[128], vendor[128], product[128], fault[400] = "";
	const struct board_data *base;
	int count, err;

	*report = (struct board_report){0};
	if (strlen(root) > BOARD_ROOT) {
		snprintf(why, why_size, "the name of the folder is too long: %d characters at most",
		         BOARD_ROOT);
		free(data);
		return -ENAMETOOLONG;
	}
	count = data ? board_data_list(folder, data, BOARDS, fault, sizeof(fault)) : -ENOMEM;
	if (count < 0) {
		report_add(report, BOARD_NOTE, "no board data: %s",
		           fault[0] ? fault : strerror(-count));
		count = 0;
	}
	board_text(root, "/proc/device-tree/model", model, sizeof(model));
	board_text(root, "/proc/device-tree/hat/vendor", vendor, sizeof(vendor));
	board_text(root, "/proc/device-tree/hat/product", product, sizeof(product));
	scene.board = board_data_model(data, (unsigned)count, model);
	scene.hat = board_data_hat(data, (unsigned)count, vendor, product);
	err = look_find(&scene, data, (unsigned)count, id, why, why_size);
	if (!err) {
		bool ports;

		base = scene.board;
		name_board(&scene, model);
		name_hat(&scene, vendor, product);
		if (base && base->pins[0])
			report_add(report, BOARD_FACT, "header: %s", base->pins);
		if (base && base->gpio_chip[0])
			report_add(report, BOARD_FACT, "GPIO lines: target gpio:%s",
			           base->gpio_chip);
		ports = report_ports(&scene);
		if (base && base->i2c >= 0)
			look_at_header(&scene, (unsigned)base->i2c);
		else
			look_at_adapters(&scene, ports);
		report_masters(&scene);
		report_notes(&scene, scene.board);
		report_notes(&scene, scene.hat);
		report_sort(report);
	}
	free(data);
	return err;
}
