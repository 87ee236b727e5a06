# Draws radiosity/error.png from what radiosity_error prints:
#   build/release/radiosity_error > errors.csv && gnuplot -e "csv='errors.csv'" tests/bench/radiosity_error.gp
set datafile separator ","
set terminal pngcairo size 1200,460 font "sans,10"
set output "radiosity/error.png"
set multiplot layout 1,2
set logscale xy
set grid
set xlabel "CPU seconds of pass one"
set ylabel "mean error of the gathered irradiance"
set xrange [0.1:10]
set key top right
# Column 8 is CPU seconds, 10 the error of gathering; one mark for each number of elements and rays.
is(scene, factors, solver, subdivision) = strcol(1) eq scene && strcol(2) eq factors && strcol(3) eq solver && strcol(4) eq subdivision
do for [scene in "cove hidden"] {
  set title scene
  plot \
    csv using (is(scene, "rays", "cg", "uniform") ? column(8) : NaN):10 with points pointtype 7 pointsize 1.4 title "rays, uniform", \
    csv using (is(scene, "rays", "cg", "adaptive") ? column(8) : NaN):10 with points pointtype 5 pointsize 1.4 title "rays, adaptive", \
    csv using (is(scene, "exact", "cg", "uniform") ? column(8) : NaN):10 with points pointtype 9 pointsize 1.4 title "exact", \
    csv using (is(scene, "point", "cg", "uniform") ? column(8) : NaN):10 with points pointtype 11 pointsize 1.4 title "point", \
    csv using (is(scene, "hemicube", "cg", "uniform") ? column(8) : NaN):10 with points pointtype 13 pointsize 1.4 title "hemicube", \
    csv using (is(scene, "none", "stochastic", "uniform") ? column(8) : NaN):10 with points pointtype 2 pointsize 1.4 title "stochastic", \
    csv using (is(scene, "exact", "hierarchical", "uniform") ? column(8) : NaN):10 with points pointtype 1 pointsize 1.4 title "hierarchical"
}
