/* SPDX-License-Identifier: MIT */
/*
 * The backends by their schemes: the one list of them, but for sim (hal/sim/table.c). A new backend
 * is one line here and one folder. Included where BACKEND(name, automatic) says what is made of
 * each; name_bus is its struct bus_ops, with all other facts. automatic: the target that "auto"
 * stands for, among others, tried in this order; "": none.
 */
BACKEND(owserver, "localhost:4304")
BACKEND(i2c, "i2c:auto")
BACKEND(w1, "w1")
BACKEND(serial, "")
BACKEND(uart, "")
BACKEND(usb, "")
BACKEND(gpio, "")
BACKEND(null, "")
