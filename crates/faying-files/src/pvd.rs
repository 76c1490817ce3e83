//! Collections of VTU files over time (PVD) for ParaView.

use std::fmt::Write as _;

/// A collection: one file per time, in the order given. Names of files are relative to the collection.
///
/// # Example
/// ```
/// let text = faying_files::pvd::collection([(0.5, "fields_0001.vtu"), (1.0, "fields_0002.vtu")]);
/// assert!(text.contains(r#"<DataSet timestep="0.5" group="" part="0" file="fields_0001.vtu"/>"#));
/// ```
pub fn collection<'a>(files: impl IntoIterator<Item = (f64, &'a str)>) -> String {
    let mut text = String::from("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n");
    for (t, file) in files {
        // writing to a String cannot fail
        let _ = writeln!(text, "    <DataSet timestep=\"{t:?}\" group=\"\" part=\"0\" file=\"{}\"/>", quick_xml::escape::escape(file));
    }
    text.push_str("  </Collection>\n</VTKFile>\n");
    text
}
