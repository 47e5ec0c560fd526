function found = version()
  % Version of libdea, such as '0.5.0'.
  found = dea_mex('version');
end
