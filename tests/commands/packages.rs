//! Files that only the packages of Windows and macOS use: manifest, property list and icons.

use roxmltree::{Document, ParsingOptions};

/// Returns four bytes of a file.
fn word(bytes: &[u8], at: usize) -> [u8; 4] {
    bytes[at..at + 4].try_into().unwrap()
}

/// Returns the side of a PNG file, pixels.
fn side(png: &[u8]) -> u32 {
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    let [width, height] = [16, 20].map(|at| u32::from_be_bytes(word(png, at)));
    assert_eq!(width, height);
    width
}

#[test]
fn the_manifest_of_windows_and_the_property_list_of_macos_fit() {
    let text = std::fs::read_to_string("assets/windows-manifest.xml").unwrap();
    let manifest = Document::parse(&text).unwrap();
    let policy = manifest.descendants().find(|node| node.has_tag_name(POLICY)).unwrap();
    assert_eq!(policy.text(), Some("detached"));
    // The keys of the property list have the values with which `scripts/package` fills the bundle.
    let text = std::fs::read_to_string("assets/Info.plist").unwrap();
    let list = Document::parse_with_options(&text, ParsingOptions { allow_dtd: true, ..Default::default() }).unwrap();
    let value = |key: &str| {
        let key = list.descendants().find(|node| node.has_tag_name("key") && node.text() == Some(key)).unwrap();
        key.next_sibling_element().unwrap().text().unwrap().to_owned()
    };
    let script = std::fs::read_to_string("scripts/package").unwrap();
    assert!(script.contains(&format!("Contents/MacOS/{}\"", value("CFBundleExecutable"))));
    assert!(script.contains(&format!("Resources/{}.icns\"", value("CFBundleIconFile"))));
    assert_eq!(value("CFBundleShortVersionString"), "@VERSION@");
    assert_eq!(value("CFBundleVersion"), "@VERSION@");
}

/// Name of the setting in <https://learn.microsoft.com/windows/console/console-allocation-policy>.
const POLICY: (&str, &str) = ("http://schemas.microsoft.com/SMI/2024/WindowsSettings", "consoleAllocationPolicy");

/// The icons contain images of the sides that their directories state.
#[test]
fn the_icons_have_images_of_every_size() {
    let ico = std::fs::read("assets/icon.ico").unwrap();
    assert_eq!(ico[..4], [0, 0, 1, 0]);
    let sides: Vec<u32> = (0..usize::from(ico[4]))
        .map(|entry| {
            let entry = 6 + 16 * entry;
            let [length, at] = [entry + 8, entry + 12].map(|at| u32::from_le_bytes(word(&ico, at)) as usize);
            let side = side(&ico[at..at + length]);
            assert_eq!(u32::from(ico[entry]), side % 256);
            side
        })
        .collect();
    assert_eq!(sides, [16, 24, 32, 48, 64, 256]);

    let icns = std::fs::read("assets/icon.icns").unwrap();
    assert_eq!((&word(&icns, 0), u32::from_be_bytes(word(&icns, 4)) as usize), (b"icns", icns.len()));
    let (mut at, mut sides) = (8, Vec::new());
    while at < icns.len() {
        let length = u32::from_be_bytes(word(&icns, at + 4)) as usize;
        sides.push(side(&icns[at + 8..at + length]));
        at += length;
    }
    assert_eq!(sides, [32, 64, 128, 256, 256, 512, 512, 1024]);
}
