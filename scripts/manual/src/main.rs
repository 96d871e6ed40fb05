//! Writes the manual page and the shell completions of the program into the folder given as argument, from the definition
//! of its command line.

use std::path::PathBuf;

use clap_complete::{Shell, generate_to};
use clap_mangen::Man;

fn main() -> std::io::Result<()> {
    let folder = PathBuf::from(std::env::args_os().nth(1).ok_or_else(|| std::io::Error::other("expected a folder"))?);
    for shell in [Shell::Bash, Shell::Fish, Shell::Zsh] {
        generate_to(shell, &mut warpbeam::cli::command(), "warpbeam", &folder)?;
    }
    let mut page = Vec::new();
    render(&mut page)?;
    std::fs::write(folder.join("warpbeam.1"), page)
}

/// Renders one manual page with every command.
fn render(page: &mut Vec<u8>) -> std::io::Result<()> {
    let mut whole = warpbeam::cli::command();
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
        // The sections of a command are parts of its own.
        let sections = [
            Man::render_synopsis_section,
            Man::render_description_section,
            Man::render_options_section,
            Man::render_extra_section,
        ];
        for section in sections {
            let mut inner = Vec::new();
            section(&man, &mut inner)?;
            page.extend_from_slice(String::from_utf8_lossy(&inner).replace(".SH ", ".SS ").as_bytes());
        }
    }
    man.render_extra_section(page)?;
    man.render_version_section(page)
}
