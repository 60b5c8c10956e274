//! The program `anergy`: runs, solves and checks models, writes reports.
#![allow(clippy::print_stderr)]

mod commands;
mod failure;
mod interrupt;
mod output;
mod progress;
mod tables;

use anergy_import::epanet::EpanetOptions;
use clap::{Parser, Subcommand};
use std::path::PathBuf;
use std::process::ExitCode;

/// Thermo-hydraulic simulation of district heating and cooling networks with prosumers.
#[derive(Debug, Parser)]
#[command(name = "anergy", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run the embedded three-house study: progress, key results, results.mcap, summary.json, report.html
    Demo {
        /// Show something else
        show: Option<commands::demo::Show>,
        /// Folder for the results (default: results/demo, or results/demo-explain)
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Run a model over time
    Run {
        /// Model file
        model: PathBuf,
        /// End of the run, for example 1d (overrides the model)
        #[arg(long, value_name = "DURATION")]
        until: Option<String>,
        /// Largest time step, for example 10s, or auto (overrides the model)
        #[arg(long, value_name = "DURATION|auto")]
        step: Option<String>,
        /// Time between recorded rows, for example 60s (overrides the model)
        #[arg(long, value_name = "DURATION")]
        record: Option<String>,
        /// Folder for results.mcap, summary.json and report.html (default: results/ and the name of the model)
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Solve the steady state with the inputs of t = 0
    Solve {
        /// Model file
        model: PathBuf,
        /// Also write the tables as JSON ("-" for standard output)
        #[arg(long, value_name = "FILE")]
        json: Option<PathBuf>,
    },
    /// Who blocks whom, which controllers will hunt, and how far it is to the limit, without simulating
    Stability {
        /// Model file
        model: PathBuf,
        /// Also write the analysis as JSON ("-" for standard output)
        #[arg(long, value_name = "FILE")]
        json: Option<PathBuf>,
        /// Try remedies in runs and say which help
        #[arg(long)]
        advise: bool,
    },
    /// Run many variants of a model on all cores: sweeps and samples; goes on where it was stopped
    Sweep {
        /// Model file
        model: PathBuf,
        #[command(flatten)]
        wanted: commands::sweep::SweepArguments,
    },
    /// Where a model and measurements disagree, which effect is missing, and what adding it brings
    Explain {
        /// Model file
        model: PathBuf,
        #[command(flatten)]
        wanted: commands::explain::ExplainArguments,
    },
    /// Find everything that is wrong with a model
    Check {
        /// Model file
        model: PathBuf,
        /// Print the model as plain nodes and edges
        #[arg(long)]
        expand: bool,
        /// List every value that was not given, with its source
        #[arg(long)]
        explain_defaults: bool,
        /// List the input signals that schedules, series and controllers can drive
        #[arg(long)]
        signals: bool,
        /// Show the weather: a year from the start of the run, its months and its type days
        #[arg(long)]
        weather: bool,
    },
    /// Print the JSON Schema of the model file
    Schema {
        /// A page in Markdown about every field instead
        #[arg(long)]
        markdown: bool,
        /// That of the variations of `anergy sweep` instead
        #[arg(long, conflicts_with = "markdown")]
        variations: bool,
    },
    /// List the houses of the library, or print one as a model file has it
    Houses {
        /// Name of a house, for example SF1
        name: Option<String>,
    },
    /// Read the network of another program into a model file, or measured series
    Import {
        #[command(subcommand)]
        format: ImportFormat,
    },
    /// Make the HTML report of recorded results
    Report {
        /// results.mcap of a run
        results: PathBuf,
        /// The report
        #[arg(long, value_name = "FILE", default_value = "report.html")]
        out: PathBuf,
    },
    /// Write recorded results as CSV, units in the names of the columns; or the network of a model as GeoJSON
    Export {
        /// results.mcap of a run, or a model file
        input: PathBuf,
        /// The table (.csv, "-" for standard output), or the network (.geojson)
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
        #[command(flatten)]
        table: commands::export::CsvOptions,
        /// Network: where x_m = 0, y_m = 0 of the model lies, deg (default: as the model says)
        #[arg(long, num_args = 2, value_names = ["LATITUDE", "LONGITUDE"], allow_negative_numbers = true)]
        origin: Option<Vec<f64>>,
    },
}

#[derive(Debug, Subcommand)]
enum ImportFormat {
    /// An EPANET input file; lists what the model does not say
    Epanet {
        /// Input file (.inp)
        file: PathBuf,
        /// The model file
        #[arg(long, value_name = "MODEL")]
        out: PathBuf,
        /// Only the state at t = 0, without schedules
        #[arg(long)]
        steady: bool,
        /// Self-acting pressure valves with a narrow band instead of ideal ones: for networks in which they
        /// work against each other
        #[arg(long)]
        self_acting: bool,
    },
    /// Measured series (CSV of a logger, or MCAP) as the file of a series of a model: SI, sorted, gaps told
    Measured {
        /// Table (.csv) or recording (.mcap)
        file: PathBuf,
        /// The series (.csv)
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
        #[command(flatten)]
        options: commands::measured::MeasuredArguments,
    },
    /// Points and lines of a geographic information system (GeoJSON, longitude and latitude)
    Geojson {
        /// Network (.geojson)
        file: PathBuf,
        /// The model file
        #[arg(long, value_name = "MODEL")]
        out: PathBuf,
        #[command(flatten)]
        options: commands::import::GeojsonArguments,
    },
    /// A net of pandapipes.to_json (water); lists what the model does not say
    Pandapipes {
        /// Net (.json)
        file: PathBuf,
        /// The model file
        #[arg(long, value_name = "MODEL")]
        out: PathBuf,
        /// Friction law, which the file does not say
        #[arg(long, value_enum, default_value = "colebrook")]
        friction: commands::import::FrictionLaw,
    },
}

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Demo { show, out } => commands::demo::demo(show, out.as_deref()),
        Command::Run { model, until, step, record, out } => {
            commands::run::run(&model, [until, step, record], out.as_deref())
        }
        Command::Explain { model, wanted } => commands::explain::explain(&model, &wanted),
        Command::Solve { model, json } => commands::solve::solve(&model, json.as_deref()),
        Command::Stability { model, json, advise } => {
            commands::stability::stability(&model, json.as_deref(), advise)
        }
        Command::Check { model, expand, explain_defaults, signals, weather } => {
            let detail = commands::check::Detail { expand, explain_defaults, signals, weather };
            commands::check::check(&model, detail)
        }
        Command::Sweep { model, wanted } => commands::sweep::sweep(&model, &wanted),
        Command::Schema { markdown, variations } => commands::schema::schema(markdown, variations),
        Command::Houses { name } => commands::houses::houses(name.as_deref()),
        Command::Import { format } => match format {
            ImportFormat::Epanet { file, out, steady, self_acting } => {
                commands::import::epanet(&file, &out, EpanetOptions { steady, self_acting })
            }
            ImportFormat::Measured { file, out, options } => {
                commands::measured::measured(&file, &out, options)
            }
            ImportFormat::Geojson { file, out, options } => {
                commands::import::geojson(&file, &out, options)
            }
            ImportFormat::Pandapipes { file, out, friction } => {
                commands::import::pandapipes(&file, &out, friction)
            }
        },
        Command::Report { results, out } => commands::report::report(&results, &out),
        Command::Export { input, out, table, origin } => {
            commands::export::export(&input, &out, &table, origin.as_deref())
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
