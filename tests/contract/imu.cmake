gimbald_test(imu_contract_test THREADS SOURCES imu_contract_test.cpp
  USES gimbald_replay gimbald_i2c_mpu6500 gimbald_i2c_lsm6dso gimbald_i2c_icm42688)
foreach(driver iio gpio)
  if(TARGET gimbald_${driver})
    string(TOUPPER ${driver} name)
    target_link_libraries(imu_contract_test PRIVATE gimbald_${driver})
    target_compile_definitions(imu_contract_test PRIVATE GIMBALD_TEST_WITH_${name})
  endif()
endforeach()
