//! Heat in the network: fronts, losses, ground, mixing, against measurements and other programs.

mod ait_pongau;
mod automatic_step;
mod cold_plug;
mod destest;
mod fluid;
mod heat_loss;
mod heat_meter;
mod mixing;
mod openmodelica_heat;
mod pipe_steps;
mod pump_heat;
mod rse_facility;
mod thermosiphon;
mod town;
mod ulg_pipe;
