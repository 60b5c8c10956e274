//! Results for every library that reads Arrow streams (polars, pyarrow, pandas, duckdb), none of which is
//! needed to give them.

use crate::result::RunResult;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{ArrayRef, Float64Array, RecordBatch, RecordBatchIterator};
use arrow_schema::{DataType, Field, Schema};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use std::collections::HashMap;
use std::sync::Arc;

#[pymethods]
impl RunResult {
    /// The results as an Arrow stream: `time_s`, then a column per channel with its unit as metadata.
    ///
    /// So `polars.DataFrame(result)`, `pyarrow.table(result)` and `pandas.DataFrame.from_arrow(result)` work.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // A consumer may ask for other types, and has to take what there is.
        drop(requested_schema);
        let batch = py.detach(|| self.batch()).map_err(PyValueError::new_err)?;
        let schema = batch.schema();
        let stream = RecordBatchIterator::new([Ok(batch)], schema);
        let stream = FFI_ArrowArrayStream::new(Box::new(stream));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }
}

impl RunResult {
    fn batch(&self) -> Result<RecordBatch, String> {
        let recording = &self.recording;
        let field = |name: &str, unit: &str| {
            let about = HashMap::from([("unit".to_owned(), unit.to_owned())]);
            Field::new(name, DataType::Float64, false).with_metadata(about)
        };
        let channels = recording.channels.iter().map(|channel| field(&channel.name, &channel.unit));
        let fields: Vec<Field> = std::iter::once(field("time_s", "s")).chain(channels).collect();
        let about = HashMap::from([("model".to_owned(), recording.header.model_name.clone())]);
        let columns = std::iter::once(&recording.time_s).chain(&recording.columns);
        let columns: Vec<ArrayRef> = columns
            .map(|column| Arc::new(Float64Array::from(column.clone())) as ArrayRef)
            .collect();
        let schema = Arc::new(Schema::new(fields).with_metadata(about));
        RecordBatch::try_new(schema, columns).map_err(|error| error.to_string())
    }
}
