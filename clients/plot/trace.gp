# SPDX-License-Identifier: Apache-2.0
#
# trace.gp - the sheet of a job, drawn by edmsim --plot and edmctl record --plot
#
# Left the path and, below it, a few jumps in detail; right what happened over
# one common time.  Before this file gnuplot is given (clients/plot/data.c):
#
#	svg, title_text, rows, t_min t_max (s), s_min s_max cut_min (mm),
#	cuts, jumps, retracts, few, has_cut, has_positioned, strip_s,
#	servo_v short_v open_v (0: not drawn), rides (U V count from X Y), zoom_n zoom_jumps zoom_from zoom_to,
#	axis_min[] axis_max[] (X Y Z A B C U V), nstates, states, in_state[] (rows), in_zoom[],
#	gap_... and feed_...: min max low high n
#	$place $gap $feed, and each with ...mean: time, least, greatest, mean
#	$axes: time, farthest place, eight axes	$share: time, 0, stacked shares
#	$jump $retract: time, place		$jumpat $retractat $begin $end
#	$path0 (positioned) $path1 (cut): eight axes	$zoom: time, place, state

page_x = 1600; page_y = 1100
if (svg) set terminal svg size page_x,page_y dynamic font 'DejaVu Sans,13' background '#ffffff'
if (!svg) set terminal pngcairo size page_x,page_y font 'DejaVu Sans,11' background '#ffffff'
set encoding utf8
set tics nomirror out scale 0.6 textcolor rgb '#303030'
set grid lc rgb '#e4e4e4' lt 1 lw 0.6
set key noenhanced

# Colours from Okabe and Ito: everybody can tell them apart.
blue = '#0072b2'; orange = '#d55e00'; yellow = '#e69f00'; green = '#009e73'
colours = 'idle #d8d8d8 travel #999999 approach #009e73 erode #0072b2 '.\
	'retract #d55e00 jump #e69f00 hold #cc79a7 fault #000000 jog #56b4e9 '.\
	'home #f0e442 probe #8c564b other #404040'
colour_of(name) = (c = 'other', c = strstrt(colours, name.' ') > 0 ? name : 'other', \
	substr(colours, strstrt(colours, c.' ') + strlen(c) + 1, \
	       strstrt(colours, c.' ') + strlen(c) + 7))
letter(i) = substr('XYZABCUV', i, i)
unit(i) = i >= 4 && i <= 6 ? 'degree' : 'mm'
larger(a, b) = a > b ? a : b
# Many marks are drawn small.
mark_size(n) = n <= 30 ? 1.3 : n <= 120 ? 0.9 : 0.6

# -- Where the panels lie -----------------------------------------------------

# As a real number: gnuplot divides whole numbers without a rest.
span(i) = axis_max[i] - axis_min[i] + 0.0
# The axes that are no X Y Z and move have a panel of their own.
others = ''; other_n = 0
do for [i = 4:8] { if (span(i) > 0) { others = others.sprintf('%d ', i); other_n = other_n + 1 } }
has_gap = gap_n > 0
panels = 3 + (has_gap ? 1 : 0) + (other_n > 0 ? 1 : 0)
left_from = 0.055; left_to = 0.375; right_from = 0.455; right_to = 0.885
top = 0.895
step = (top - 0.065) / (panels - 0.45)

reset_panel = "unset label; set autoscale; unset xlabel; unset ylabel; ".\
	"set size noratio; set format '%g'; set xtics auto offset 0,0; ".\
	"set ytics auto offset 0,0; set border 3 lw 0.8 lc rgb '#606060'; ".\
	"unset xrange; unset yrange"
place_panel(l, r, b, t) = sprintf("set lmargin at screen %f; set rmargin at screen %f; ".\
	"set bmargin at screen %f; set tmargin at screen %f", l, r, b, t)
name_panel(name, x, y) = sprintf("set label 3 \"%s\" at screen %f,%f left font ',13' front", name, x, y)
key_below(y) = sprintf("set key at screen 0.05,%f left top horizontal Left reverse ".\
	"maxrows 2 samplen 2 width -1 font ',10'", y - 0.012)

set multiplot
set label 1 title_text at screen 0.02,0.972 left noenhanced font ',17' front
set label 2 sprintf('%.1f s,  farthest %.3f mm,  jumps: %d,  retracts: %d,  %.0f records', \
	t_max - t_min, s_max, jumps, retracts, rows) at screen 0.98,0.972 right \
	font ',12' tc rgb '#404040' noenhanced
set border 3 lw 0.8 lc rgb '#606060'

# -- The path: from above, from a side, or in space ---------------------------

# Axes that move worth seeing: of X Y Z; if none does, of U V; else of A B C.
array view[3]
seen = 0
most = 0.0
do for [group = 1:3] {
	first = group == 1 ? 1 : group == 2 ? 7 : 4
	last = group == 1 ? 3 : group == 2 ? 8 : 6
	if (seen == 0) {
		do for [i = first:last] { most = larger(most, span(i)) }
		do for [i = first:last] {
			if (most > 0 && span(i) > most / 200) { seen = seen + 1; view[seen] = i }
		}
		# A lone axis stands upright on a neighbour that rests.
		if (seen == 1) { view[2] = view[1]; view[1] = view[2] == first ? first + 1 : first; seen = 2 }
	}
}
if (seen == 0) { seen = 2; view[1] = 1; view[2] = 2 }
solid = seen == 3
# On a wire machine U V are the upper guide: how far it is from above X Y, or its
# place.
guided = !solid && has_cut && view[1] == 1 && view[2] == 2 && span(7) + span(8) > 0
if (guided) {
	do for [k = 1:2] {
		stats $path1 using (rides * column(k) + column(k + 6)) nooutput
		if (STATS_min < axis_min[k]) { axis_min[k] = STATS_min }
		if (STATS_max > axis_max[k]) { axis_max[k] = STATS_max }
		most = larger(most, span(k))
	}
}

least = most
do for [k = 1:seen] { least = span(view[k]) > 0 && span(view[k]) < least ? span(view[k]) : least }
room(i) = span(i) <= most / 200 ? (most > 0 ? most / 2.0 : 1.0) : larger(span(i) * 0.06, most * 0.02)
do for [k = 1:seen] {
	i = view[k]
	eval sprintf("set %srange [%.9g:%.9g]; set %slabel '%s, %s'", substr('xyz', k, k), \
		axis_min[i] - room(i) + 0.0, axis_max[i] + room(i) + 0.0, substr('xyz', k, k), letter(i), unit(i))
}
bottom = zoom_n > 0 ? 0.46 : 0.10
eval place_panel(left_from, left_to, bottom, 0.845)
# One scale for all axes, unless one of them is too short to be seen by it.
equal = least > most / 20
eval name_panel(equal ? 'Path' : 'Path; its axes have scales of their own', left_from, 0.920)
eval key_below(0.920)
if (solid) {
	# The shorter side of the panel is the edge of a box along the longer of
	# the first two axes, or of a cube.  It is chosen so that the whole box,
	# as it is seen, fits beside the marks.
	tilt = 62; turn = 38
	set view tilt, turn, 1, 1
	set xyplane 0
	array edge[3]
	do for [k = 1:3] { edge[k] = equal ? span(view[k]) + 2 * room(view[k]) : 1.0 }
	wide = edge[1] * cos(turn * pi / 180) + edge[2] * sin(turn * pi / 180)
	deep = edge[1] * sin(turn * pi / 180) + edge[2] * cos(turn * pi / 180)
	high = deep * cos(tilt * pi / 180) + edge[3] * sin(tilt * pi / 180)
	from_y = bottom - 0.014; to_y = 0.839; from_x = 0.090; to_x = 0.335
	pixels = larger(edge[1], edge[2]) / \
		larger(wide / (to_x - from_x) / page_x, high / (to_y - from_y) / page_y)
	eval place_panel((from_x + to_x - pixels / page_x) / 2, (from_x + to_x + pixels / page_x) / 2, \
		(from_y + to_y - pixels / page_y) / 2, (from_y + to_y + pixels / page_y) / 2)
	set zlabel rotate by 90 offset 0.2,0
	set xlabel offset -1,-0.8; set ylabel offset 1,-0.8
	set xtics offset 0,-0.3; set ytics offset 0,-0.3
	# The same marks on all three, or a short axis has no room for its own.
	if (equal) {
		decade = 10.0 ** floor(log10(most / 6))
		mark = decade * (most / 6 / decade > 5 ? 10 : most / 6 / decade > 2 ? 5 : 2)
		set xtics mark; set ytics mark; set ztics mark
	}
	set border 4095 lc rgb '#d0d0d0'
}
if (equal) { if (solid) { set view equal xyz } else { set size ratio -1 } }
u = solid ? sprintf('using %d:%d:%d', view[1], view[2], view[3]) : sprintf('using %d:%d', view[1], view[2])
cmd = solid ? 'splot ' : 'plot '
if (jumps > 0) cmd = cmd.sprintf("$jumpat %s with points pt 6 ps %f lw 1.3 lc rgb '%s' title 'jumps: %d', ", u, mark_size(jumps), yellow, jumps)
if (retracts > 0) cmd = cmd.sprintf("$retractat %s with points pt 9 ps %f lc rgb '%s' title 'retracts: %d', ", u, mark_size(retracts), orange, retracts)
if (has_positioned) cmd = cmd.sprintf("$path0 %s with lines lw 1.4 dt (6,4) lc rgb '#999999' title 'positioned', ", u)
if (has_cut) cmd = cmd.sprintf("$path1 %s with lines lw 2.2 lc rgb '%s' title 'cut', ", u, blue)
if (guided) cmd = cmd."$path1 using (rides * $1 + $7):(rides * $2 + $8) with lines lw 1.2 lc rgb green title 'upper guide', "
cmd = cmd.sprintf("$begin %s with points pt 7 ps 1.3 lc rgb '#202020' title 'start', ", u)
cmd = cmd.sprintf("$end %s with points pt 5 ps 1.2 lc rgb '#202020' title 'farthest'", u)
eval cmd
eval reset_panel

# -- A few jumps in detail ----------------------------------------------------

if (zoom_n > 0) {
	eval place_panel(left_from, left_to, 0.065, 0.325)
	eval name_panel(zoom_jumps > 2 ? 'Three jumps in detail' : zoom_jumps > 0 ? 'A jump in detail' : 'A retract in detail', left_from, 0.378)
	eval key_below(0.378)
	set xrange [zoom_from:zoom_to]
	set xlabel 'time, s'
	set ylabel 'place along the path, mm'
	cmd = ''
	do for [i = 0:nstates - 1] {
		if (in_zoom[i + 1]) {
			cmd = cmd.(cmd eq '' ? 'plot ' : ', ').sprintf("$zoom using 1:($3 == %d ? $2 : NaN) with lines lw 2.4 lc rgb '%s' title '%s'", i, colour_of(word(states, i + 1)), word(states, i + 1))
		}
	}
	eval cmd
	eval reset_panel
}

# -- Over time ----------------------------------------------------------------

unit_s = t_max - t_min > 3 * 3600 ? 3600 : t_max - t_min > 600 ? 60 : 1
unit_name = unit_s == 3600 ? 'h' : unit_s == 60 ? 'min' : 's'
alone = t_max > t_min ? 0 : 0.5
set key at graph 1.015,1 left top vertical Left reverse maxrows auto maxcols auto samplen 1.5 width -2 font ',10'

panel_n = 0
next_panel(name, height) = sprintf("%s; %s; set xrange [%.9g:%.9g]; set format x ''; panel_n = panel_n + 1", \
	place_panel(right_from, right_to, top - panel_n * step - height * step, top - panel_n * step), \
	name_panel(name, right_from, top - panel_n * step + 0.022), \
	(t_min - alone) / unit_s, (t_max + alone) / unit_s)
pad(low, high) = high > low ? 0.05 * (high - low) : 1

eval next_panel(cuts ? 'Place along the path, from the first cut' : 'Place along the path', 0.72)
low = cut_min - 0.05 * (s_max - cut_min)
set yrange [low:s_max + pad(low, s_max)]
set ylabel 'mm'
cmd = "plot $placemean using ($1/unit_s):2:3 with filledcurves fc rgb '#f6dfae' title '".(few ? 'swept' : 'swept by jumps')."', "
if (few) cmd = cmd."$placemean using ($1/unit_s):2 with lines lw 0.9 lc rgb yellow notitle, "
cmd = cmd."$axes using ($1/unit_s):2 with lines lw 2.2 lc rgb blue title 'farthest'"
if (jumps > 0 && few) cmd = cmd.sprintf(", $jump using ($1/unit_s):2 with points pt 6 ps 0.9 lw 1.3 lc rgb yellow title 'jumps: %d'", jumps)
if (retracts > 0) cmd = cmd.sprintf(", $retract using ($1/unit_s):2 with points pt 9 ps %f lc rgb orange title 'retracts: %d'", mark_size(retracts), retracts)
eval cmd
eval reset_panel

level(name, v, colour) = v > 0 ? sprintf(", %.9g with lines lw 1.4 dt (8,5) lc rgb '%s' title '%s: %.4g V'", v, colour, name, v) : ''
if (has_gap) {
	eval next_panel(sprintf('Gap voltage%s, %.4g to %.4g V', cuts ? ' while eroding' : '', gap_min, gap_max), 0.66)
	high = larger(gap_high, 1.15 * open_v)
	set yrange [0:high + pad(0, high)]
	set ylabel 'V'
	cmd = "plot $gap using ($1/unit_s):2:3 with filledcurves fc rgb '#cfe3f1' title 'least to most', ".\
	      "$gapmean using ($1/unit_s):4 with lines lw 1.6 lc rgb blue title 'mean'"
	cmd = cmd.level('open', open_v, green).level('servo', servo_v, '#202020').level('short', short_v, orange)
	eval cmd
	eval reset_panel
}

# A period's feed is whole pulses or none, so extremes would fill the panel
# whatever the gap does: the mean of each strip, and that from jump to jump.
if (feed_n > 0) {
	eval next_panel(sprintf('Feed%s, %.4g to %.4g mm/min', cuts ? ' while eroding' : '', feed_min * 60, feed_max * 60), 0.66)
	low = feed_low * 60; high = feed_high * 60
	set yrange [(low < 0 ? low - pad(low, high) : low):high + pad(low, high)]
	set ylabel 'mm/min'
	cmd = 'plot '
	if (!few) { cmd = cmd.sprintf("$feed using ($1/unit_s):(60*$4) with lines lw 1 lc rgb '#9ec5e3' title 'mean of %.2g s', ", strip_s) }
	eval cmd."$feedmean using ($1/unit_s):(60*$4) with lines lw 1.6 lc rgb blue title 'mean', 0 with lines lw 0.8 lc rgb '#606060' notitle"
	eval reset_panel
}

if (other_n > 0) {
	eval next_panel('Rotary axes and upper guide', 0.66)
	set ylabel 'degree or mm'
	cmd = ''
	do for [k = 1:other_n] {
		i = int(word(others, k))
		cmd = cmd.(cmd eq '' ? 'plot ' : ', ').sprintf("$axes using ($1/unit_s):%d with lines lw 1.6 lc %d title '%s, %s'", i + 2, k, letter(i), unit(i))
	}
	eval cmd
	eval reset_panel
}

eval next_panel('Share of each state', 0.55)
set format x '%g'
set xlabel 'time, '.unit_name
set ylabel '%'
set yrange [0:100]
set ytics 50
cmd = ''
do for [k = 1:nstates] {
	i = nstates - k + 1
	if (in_state[i] > 0) {
		cmd = cmd.(cmd eq '' ? 'plot ' : ', ').sprintf("$share using ($1/unit_s):%d:%d with filledcurves fc rgb '%s' title '%s: %.1f %%'", i + 1, i + 2, colour_of(word(states, i)), word(states, i), 100.0 * in_state[i] / rows)
	}
}
eval cmd
unset multiplot
