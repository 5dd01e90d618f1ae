# SPDX-License-Identifier: Apache-2.0
#
# contour.gp - contour error over time, drawn by edmctl identify --plot
#
# Before this file gnuplot is given (clients/ctl/contour.c): svg, and $error:
# time in s, then measured, predicted and missed by the model, in um.

if (svg) set terminal svg size 1000,500 font 'sans,12' background 'white'
if (!svg) set terminal pngcairo size 1000,500 font 'sans,12' background 'white'
set grid lc '#dddddd'
set key above
set yrange [0:*]
set xlabel 'time, s'
set ylabel 'um'
plot $error using 1:2 with lines lw 2 lc '#d55e00' title 'contour error, measured', \
     '' using 1:3 with lines lc '#0072b2' title 'predicted', \
     '' using 1:4 with lines lc '#009e73' title 'machine off the model'
