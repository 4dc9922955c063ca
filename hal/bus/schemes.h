/* SPDX-License-Identifier: MIT */
/*
 * The backends by their schemes: the one list of them, but for sim (hal/sim/table.c). A new backend
 * is one line here and one folder. Included where BACKEND(name) says what is made of each; name_bus
 * is its struct bus_ops.
 */
BACKEND(owserver)
BACKEND(i2c)
BACKEND(w1)
BACKEND(gpio)
BACKEND(null)
