/* SPDX-License-Identifier: MIT */
/* The DS9490R that are plugged in, by the kernel's list of USB devices: no device is opened. */
#include <dirent.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/usb/find.h"

#define PRODUCT "4fa/2490/"

bool usb_is_name(const char *text)
{
	static const char digits[] = "0123456789";
	size_t n = strspn(text, digits);

	if (!n || text[n] != '-')
		return false;
	do {
		text += n + 1;
		n = strspn(text, digits);
	} while (n && text[n] == '.');
	return n && !text[n];
}

/* What the kernel says of a device or an interface: the value behind KEY=, or "". */
static void read_key(const char *sysfs, const char *name, const char *key, char *value, size_t size)
{
	char path[PATH_MAX], text[1024];
	size_t len = strlen(key);
	int fd;

	*value = '\0';
	snprintf(path, sizeof(path), "%s/%s/uevent", sysfs, name);
	fd = open(path, O_RDONLY | O_CLOEXEC);
	if (fd < 0)
		return;
	ssize_t n = read(fd, text, sizeof(text) - 1);

	close(fd);
	text[n > 0 ? n : 0] = '\0';
	for (char *line = text; *line; line += strcspn(line, "\n"), line += *line == '\n')
		if (strncmp(line, key, len) == 0 && line[len] == '=')
			snprintf(value, size, "%.*s", (int)strcspn(line + len + 1, "\n"),
			         line + len + 1);
}

bool usb_is_adapter(int fd)
{
	uint16_t device[9]; /* its descriptor; the kernel has its words in this machine's order */

	return pread(fd, device, sizeof(device), 0) == sizeof(device) && device[4] == 0x04fa &&
	       device[5] == 0x2490;
}

static int compare(const void *a, const void *b)
{
	return strverscmp(((const struct usb_place *)a)->name, ((const struct usb_place *)b)->name);
}

unsigned usb_find(const char *sysfs, struct usb_place places[USB_PLACES])
{
	DIR *dir = opendir(sysfs);
	unsigned count = 0;

	for (struct dirent *entry; dir && count < USB_PLACES && (entry = readdir(dir));) {
		struct usb_place *place = &places[count];
		char text[40], interface[USB_NAME + 8];

		if (!usb_is_name(entry->d_name) || strlen(entry->d_name) >= USB_NAME)
			continue;
		read_key(sysfs, entry->d_name, "PRODUCT", text, sizeof(text));
		if (strncmp(text, PRODUCT, strlen(PRODUCT)) != 0)
			continue;
		snprintf(place->name, sizeof(place->name), "%.*s", USB_NAME - 1, entry->d_name);
		read_key(sysfs, place->name, "DEVNAME", text, sizeof(text));
		snprintf(place->device, sizeof(place->device), "/dev/%s", text);
		snprintf(interface, sizeof(interface), "%s:1.0", place->name);
		read_key(sysfs, interface, "DRIVER", place->driver, sizeof(place->driver));
		count += *text != '\0';
	}
	if (dir)
		closedir(dir);
	qsort(places, count, sizeof(*places), compare);
	return count;
}
