//! Shell completions and manual page, generated from the command line definition.

use std::process::ExitCode;

use clap::CommandFactory as _;
use clap_mangen::Man;

use super::args::Cli;
use super::{CliError, text};

/// Prints shell completions.
pub(super) fn completions(shell: clap_complete::Shell) -> Result<ExitCode, CliError> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "warpbeam", &mut script);
    print(&script)
}

/// Prints one manual page with every command.
pub(super) fn man() -> Result<ExitCode, CliError> {
    let mut page = Vec::new();
    render(&mut page)?;
    print(&page)
}

fn print(bytes: &[u8]) -> Result<ExitCode, CliError> {
    text::print(&String::from_utf8_lossy(bytes))?;
    Ok(ExitCode::SUCCESS)
}

fn render(page: &mut Vec<u8>) -> std::io::Result<()> {
    let mut whole = Cli::command();
    whole.build();
    let commands: Vec<clap::Command> = whole.get_subcommands().filter(|c| c.get_name() != "help").cloned().collect();
    let man = Man::new(whole);
    man.render_title(page)?;
    man.render_name_section(page)?;
    man.render_synopsis_section(page)?;
    man.render_description_section(page)?;
    for command in commands {
        page.extend_from_slice(format!(".SH COMMAND {}\n", command.get_name().to_uppercase()).as_bytes());
        let man = Man::new(command);
        // Convert sections of a command to subsections.
        for section in [Man::render_synopsis_section, Man::render_description_section, Man::render_options_section] {
            let mut inner = Vec::new();
            section(&man, &mut inner)?;
            page.extend_from_slice(String::from_utf8_lossy(&inner).replace(".SH ", ".SS ").as_bytes());
        }
        let mut notes = Vec::new();
        man.render_extra_section(&mut notes)?;
        page.extend_from_slice(String::from_utf8_lossy(&notes).replace(".SH ", ".SS ").as_bytes());
    }
    man.render_extra_section(page)?;
    man.render_version_section(page)
}
